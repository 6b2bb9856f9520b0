// A dam break in a tank, stirred with the mouse or a finger. The library computes in the page; WebGL2 draws the
// particles straight from the module's memory.
import { PbfError, Solver, load } from "pbf";
import { Picture } from "./picture.mjs";

const tank = [2, 1.2, 0.5];
const ball = { shape: "sphere", radius: 0.13 };

const element = (id) => document.getElementById(id);
const canvas = element("canvas");

// A block of so many particles, or a few less, at the left.
function dam(particles) {
  const width = 0.7, height = 0.9;
  const spacing = Math.cbrt((width * height * tank[2]) / particles);
  const counts = [width, height, tank[2]].map((side) => Math.floor(side / spacing));
  const positions = new Float32Array(3 * counts[0] * counts[1] * counts[2]);
  let n = 0;
  for (let z = 0; z < counts[2]; ++z)
    for (let y = 0; y < counts[1]; ++y)
      for (let x = 0; x < counts[0]; ++x)
        for (const cell of [x, y, z]) positions[n++] = (cell + 0.5) * spacing;
  return { spacing, positions };
}

class Demo {
  #held = null; // where the pointer holds the ball, in the tank
  #collides = false;
  #last = 0;
  #stepTimes = [];
  #frameTimes = [];

  constructor(picture) {
    this.picture = picture;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.#hold(event);
    });
    canvas.addEventListener("pointermove", (event) => this.#held && this.#hold(event));
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => (this.#held = null));
    element("again").addEventListener("click", () => this.begin());
    element("size").addEventListener("change", () => this.begin());
  }

  begin() {
    const { spacing, positions } = dam(Number(element("size").value));
    this.solver?.destroy();
    this.solver = new Solver({
      capacity: positions.length / 3,
      params: {
        spacing,
        smoothingRadius: (5 / 3) * spacing,
        domainMax: tank,
        timeStep: 1 / 120,
        maxDepenetrationSpeed: 2,
      },
    });
    this.solver.addParticles(positions);
    this.radius = spacing / 2;
    this.#collides = false;
    this.#stepTimes = [];
    this.#frameTimes = [];
    element("count").textContent = this.solver.count;
  }

  #hold(event) {
    const middle = this.picture.placeOf(event.clientX, event.clientY, tank[2] / 2);
    this.#held = middle.map((x, k) => Math.min(Math.max(x, 0), tank[k]));
  }

  // The ball goes where the pointer is now, in the time of the steps that follow.
  #moveBall(duration) {
    if (!this.#held) {
      if (this.#collides) this.solver.setColliders([]);
      this.#collides = false;
    } else if (!this.#collides) {
      this.solver.setColliders([{ ...ball, position: this.#held }]);
      this.#collides = true;
    } else {
      this.solver.moveColliders([{ ...ball, position: this.#held }], duration);
    }
  }

  get ballPlace() {
    return this.#collides ? this.solver.colliders[0].position : null;
  }

  // Two steps a frame where the display has 60 a second; where it has more, or a frame was late, time as it goes.
  frame(now) {
    const { timeStep } = this.solver.params;
    const passed = this.#last ? (now - this.#last) / 1000 : 0;
    if (this.#last) this.#note(this.#frameTimes, now - this.#last, "frame");
    this.#last = now;
    const steps = Math.min(Math.max(Math.round(passed / timeStep), 1), 2);
    this.#moveBall(steps * timeStep);
    const begin = performance.now();
    this.solver.step(steps);
    this.#note(this.#stepTimes, (performance.now() - begin) / steps, "step");
    this.picture.draw(this.solver, this.radius, this.ballPlace && { place: this.ballPlace, radius: ball.radius });
  }

  // The mean of the last 30.
  #note(times, milliseconds, id) {
    times.push(milliseconds);
    if (times.length > 30) times.shift();
    element(id).textContent = (times.reduce((a, b) => a + b) / times.length).toFixed(1);
  }
}

function show(error) {
  element("error").textContent = error instanceof PbfError ? error.message : String(error);
  console.error(error);
}

try {
  // The bytes are what build.py puts in; else pbf.wasm and pbf-threads.wasm are loaded.
  const { threads, why } = await load(globalThis.pbfModule, { threads: 0, threadsSource: globalThis.pbfThreads });
  element("threads").textContent = threads;
  element("why").textContent = why ? `One thread: ${why}` : "";
  const demo = new Demo(new Picture(canvas, tank));
  demo.begin();
  globalThis.demo = demo; // for a look from the console
  const next = (now) => {
    try {
      demo.frame(now);
      requestAnimationFrame(next);
    } catch (error) {
      show(error);
    }
  };
  requestAnimationFrame(next);
} catch (error) {
  show(error);
}
