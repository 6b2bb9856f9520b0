/* Crates that float, in both directions: the fluid moves them, and they move the fluid. Bullet has
 * the rigid bodies, with their contacts; built where it is found (Debian's libbullet-dev).
 *
 *   floating              crates of a tenth, a half and a hundred times the density of water
 *   floating RATIO …      of these densities over water's, at most four; 0.01 … 100 are stable
 *
 * Once a frame Bullet moves the bodies, by what the fluid has done to them in the frame before
 * (pbf_get_collider_loads), and the fluid goes on with colliders on the way to where they are then
 * (pbf_move_colliders).
 *
 * A body that speeds up has to speed up water, too, its added mass, and water tells so by a force
 * that comes a frame late. A body lighter than that water answers with a larger acceleration to the
 * other side, and flies off after some frames. So it gets the mass of water that it can displace
 * beside its own, as far as it is wet, and half of the force that this mass takes:
 *
 *   (m + ma) a = F + m g + ma a_last / 2
 *
 * Causin, Gerbeau & Nobile (Comput. Methods Appl. Mech. Engrg. 194, 2005) tell when the like
 * converges. Where nothing speeds up, which is where a body floats, F = -m g, whatever ma is. */
#include <btBulletDynamicsCommon.h>
#include <pbf/pbf.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

namespace {

const double spacing = 0.05, water = 1000, depth = 0.5, width = 1.2, half = 0.15;
const double frame_time = 1.0 / 60;
const int steps = 2, frames = 480;

void check(pbf_status status) {
  if (status == PBF_OK) return;
  std::fprintf(stderr, "%s\n", pbf_last_error());
  std::exit(1);
}

/* ---- Rigid bodies --------------------------------------------------------------------------- */

struct crate {
  double ratio; /* of its density to water's */
  std::unique_ptr<btRigidBody> body;
  btVector3 v, w;                    /* velocities at the end of the last frame, … */
  btVector3 a{0, 0, 0}, wa{0, 0, 0}; /* … and how they changed in it */
};

/* The tank's floor and sides, and crates. Gravity is among the forces that crates are given. */
struct rigid_bodies {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broad_phase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broad_phase, &solver, &configuration};
  btBoxShape box{btVector3(half, half, half)};
  std::vector<std::unique_ptr<btStaticPlaneShape>> planes;
  std::vector<std::unique_ptr<btRigidBody>> walls;
  std::vector<crate> crates;

  rigid_bodies() {
    world.setGravity(btVector3(0, 0, 0));
    add_wall(btVector3(0, 1, 0), 0);
    for (int axis = 0; axis < 3; axis += 2) {
      btVector3 normal(0, 0, 0);
      normal[axis] = 1;
      add_wall(normal, 0);
      add_wall(-normal, btScalar(-width));
    }
  }

  ~rigid_bodies() {
    for (crate &c : crates) world.removeRigidBody(c.body.get());
    for (auto &wall : walls) world.removeRigidBody(wall.get());
  }

  void add_wall(const btVector3 &normal, btScalar distance) {
    planes.push_back(std::make_unique<btStaticPlaneShape>(normal, distance));
    walls.push_back(std::make_unique<btRigidBody>(
        btRigidBody::btRigidBodyConstructionInfo(0, nullptr, planes.back().get())));
    world.addRigidBody(walls.back().get());
  }

  void add_crate(double ratio, double x, double z) {
    crate c{ratio,
            std::make_unique<btRigidBody>(
                btRigidBody::btRigidBodyConstructionInfo(1, nullptr, &box, btVector3(1, 1, 1))),
            btVector3(0, 0, 0), btVector3(0, 0, 0)};
    btTransform pose(btQuaternion(btVector3(0, 0, 1), btScalar(0.2)), /* tilted a little */
                     btVector3(btScalar(x), btScalar(depth + half + spacing), btScalar(z)));
    c.body->setWorldTransform(pose);
    c.body->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(c.body.get());
    crates.push_back(std::move(c));
  }
};

/* code: push */
btVector3 vector_of(const double v[3]) {
  return btVector3(btScalar(v[0]), btScalar(v[1]), btScalar(v[2]));
}

/* By the mean force and torque of the frame that has ended. */
void push(crate *c, const pbf_collider_load &load) {
  const double side = 2 * half, displaced = water * side * side * side;
  const double wet = std::fmin(1, load.wetted_area / (6 * side * side));
  const btScalar mass = btScalar(c->ratio * displaced),
                 added = btScalar(displaced * std::sqrt(wet));
  const btScalar turning = btScalar(side * side / 6); /* a cube's inertia over its mass */
  const btScalar per_time = btScalar(load.time_sum > 0 ? water / load.time_sum : 0);
  const btVector3 weight(0, btScalar(-9.81) * mass, 0);
  c->body->setMassProps(mass + added, turning * (mass + added) * btVector3(1, 1, 1));
  c->body->updateInertiaTensor();
  c->body->applyCentralForce(per_time * vector_of(load.impulse_sum) + weight + added / 2 * c->a);
  c->body->applyTorque(per_time * vector_of(load.angular_impulse_sum) +
                       turning * added / 2 * c->wa);
}
/* end */

void note_accelerations(crate *c) {
  const btVector3 v = c->body->getLinearVelocity(), w = c->body->getAngularVelocity();
  c->a = (v - c->v) / btScalar(frame_time);
  c->wa = (w - c->w) / btScalar(frame_time);
  c->v = v;
  c->w = w;
}

/* ---- Fluid ---------------------------------------------------------------------------------- */

pbf_collider collider_of(const crate &c) {
  const btTransform &pose = c.body->getWorldTransform();
  const btQuaternion turned = pose.getRotation();
  pbf_collider box;
  check(pbf_collider_init(&box, sizeof box, PBF_COLLIDER_BOX));
  for (int k = 0; k < 3; ++k) {
    box.position[k] = pose.getOrigin()[k];
    box.half_extents[k] = half;
  }
  for (int k = 0; k < 4; ++k) box.orientation[k] = turned[k];
  return box;
}

std::vector<pbf_collider> colliders_of(const rigid_bodies &bodies) {
  std::vector<pbf_collider> boxes;
  for (const crate &c : bodies.crates) boxes.push_back(collider_of(c));
  return boxes;
}

pbf_solver *tank() {
  pbf_desc desc;
  pbf_params params;
  pbf_solver *fluid;
  const int n = int(std::lround(width / spacing)), layers = int(std::lround(depth / spacing));
  std::vector<float> x;
  for (int i = 0; i < n * n * layers; ++i) {
    const int at[3] = {i % n, i / n / n, i / n % n};
    for (int k : at) x.push_back(float(spacing * (k + 0.5)));
  }
  check(pbf_desc_init(&desc, sizeof desc));
  check(pbf_params_init(&params, sizeof params));
  desc.capacity = uint32_t(n * n * layers);
  params.smoothing_radius = 2 * spacing;
  params.time_step = frame_time / steps;
  params.loads = 1;
  for (int k = 0; k < 3; ++k) params.domain_max[k] = k == 1 ? 2 : width;
  check(pbf_create(&desc, &params, &fluid));
  check(pbf_add_particles(fluid, desc.capacity, x.data(), nullptr, nullptr));
  return fluid;
}

/* code: frame */
void run_frame(rigid_bodies *bodies, pbf_solver *fluid, std::vector<pbf_collider_load> *loads) {
  const uint32_t count = uint32_t(loads->size());
  for (uint32_t i = 0; i < count; ++i) push(&bodies->crates[i], (*loads)[i]);
  bodies->world.stepSimulation(btScalar(frame_time), 1, btScalar(frame_time));
  for (crate &c : bodies->crates) note_accelerations(&c);
  const std::vector<pbf_collider> boxes = colliders_of(*bodies);
  check(pbf_move_colliders(fluid, count, boxes.data(), frame_time));
  check(pbf_step(fluid, steps));
  check(pbf_get_collider_loads(fluid, count, loads->data()));
}
/* end */

void tell(const rigid_bodies &bodies, int second) {
  std::printf("%d s:", second);
  for (const crate &c : bodies.crates)
    std::printf("  %g at %.3f m, %+.3f m/s", c.ratio,
                double(c.body->getWorldTransform().getOrigin()[1]),
                double(c.body->getLinearVelocity()[1]));
  std::printf("\n");
}

/* Whether all have come to rest, or nearly. */
bool are_calm(const rigid_bodies &bodies) {
  for (const crate &c : bodies.crates)
    if (!(c.body->getLinearVelocity().length() < btScalar(0.3))) return false;
  return true;
}

}  // namespace

int main(int argc, char **argv) {
  rigid_bodies bodies;
  std::vector<double> ratios = {0.1, 0.5, 100};
  if (argc > 1) ratios.clear();
  for (int i = 1; i < argc && i < 5; ++i) ratios.push_back(std::atof(argv[i]));
  for (size_t i = 0; i < ratios.size(); ++i)
    bodies.add_crate(ratios[i], i % 2 ? 0.9 : 0.3, i / 2 ? 0.9 : 0.3);
  pbf_solver *fluid = tank();
  std::vector<pbf_collider_load> loads(ratios.size());
  for (pbf_collider_load &load : loads) load.struct_size = sizeof load;
  const std::vector<pbf_collider> boxes = colliders_of(bodies);
  check(pbf_set_colliders(fluid, uint32_t(boxes.size()), boxes.data()));
  for (int frame = 0; frame < frames; ++frame) {
    run_frame(&bodies, fluid, &loads);
    if (frame % 120 == 119) tell(bodies, (frame + 1) / 60);
  }
  const bool calm = are_calm(bodies);
  pbf_destroy(fluid);
  return calm ? 0 : 1;
}
