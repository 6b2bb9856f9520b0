/* Fluid that sleeps and wakes: case 31. */
#include <cmath>

#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {
namespace {

constexpr uint32_t most_steps = 3600;

// As pbf/params.h recommends.
void allow_sleep(pbf_params &params) {
  params.sleep_speed = 0.1 * std::sqrt(-params.gravity[1] * spacing);
  params.sleep_time = 0.5;
}

// Some backends let nothing sleep, and say so.
bool refuses(Record &record, const Start &start) {
  const pbf_desc desc = desc_for(record, start.dimension, 1, 0);
  pbf_solver *solver = nullptr;
  const pbf_status status = pbf_create(&desc, &start.params, &solver);
  pbf_destroy(solver);
  if (status != PBF_ERROR_UNSUPPORTED) return false;
  record.note("absent", pbf_last_error());
  return true;
}

void until_asleep(Trial &trial) {
  for (uint32_t steps = 0; steps < most_steps && trial.stats().asleep < trial.count(); steps += 60)
    trial.step(60);
}

// A ball that comes down on the fluid, at half a metre a second.
pbf_collider ball_above(const Trial &trial, double side) {
  pbf_collider ball;
  must(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.radius = 0.05;
  ball.position[0] = ball.position[2] = side / 2;
  ball.position[1] = trial.stats().position_max[1] + support + ball.radius + spacing;
  ball.velocity[1] = -0.5;
  return ball;
}

// Steps until a particle wakes, and notes how far the ball is then from the fluid as it slept.
void touch(Record &record, Trial &trial, const pbf_collider &ball) {
  const double surface = trial.stats().position_max[1];
  pbf_collider now = ball;
  must(pbf_set_colliders(trial.solver(), 1, &ball));
  record.note("asleep before the touch", trial.stats().asleep);
  uint32_t asleep = trial.count();
  for (uint32_t step = 0; step < 60 && asleep == trial.count(); ++step) {
    trial.step(1);
    asleep = trial.stats().asleep;
  }
  must(pbf_get_collider(trial.solver(), 0, &now));
  record.note("asleep at the touch", asleep);
  record.note("gap at the touch", now.position[1] - now.radius - surface);
}

}  // namespace

void sleep_and_wake(Record &record) {
  const double side = record.quick_or(0.4, 0.8);
  Start start = tank({side, 1, side}, {side, record.quick_or(0.3, 0.6), side});
  Start sleepy = start;
  allow_sleep(sleepy.params);
  if (refuses(record, sleepy)) return;

  Trial trial(record, "falling-asleep", sleepy);
  until_asleep(trial);
  record.note("asleep", trial.stats().asleep);
  trial.begin("asleep");
  trial.run(1200, 2);
  Trial awake(record, "settling", start);
  awake.step(static_cast<uint32_t>(trial.info().step) - 1200);
  awake.begin("awake");
  awake.run(120, 12);

  pbf_params stirred = trial.params();
  stirred.gravity[0] = 1e-9;  // nothing, but a change
  trial.change(stirred, "woken");
  record.note("asleep after the change", trial.stats().asleep);
  for (int k = 0; k < 12; ++k) trial.run(k < 4 ? 1 : 8, 1);
  until_asleep(trial);
  trial.begin("asleep-again");
  touch(record, trial, ball_above(trial, side));
  trial.begin("touched");
  trial.run(30, 15);
  trial.draw("A ball has woken fluid that slept");
}

}  // namespace bench::stability
