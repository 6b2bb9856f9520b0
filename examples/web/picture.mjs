// Particles as shaded discs, and the edges of the tank, by WebGL2. The camera looks along -z.
const vertexSource = `#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 velocity;
uniform vec3 eye;
uniform vec2 zoom;     // of lengths at distance 1 to the canvas, -1 ... 1
uniform float pixels;  // of a length at distance 1
uniform float radius;
out float speed;
void main() {
  vec3 seen = position - eye;
  float distance = -seen.z;
  gl_Position = vec4(zoom * seen.xy, distance * (distance - 0.1) / 10.0, distance);
  gl_PointSize = 2.0 * pixels * radius / distance;
  speed = length(velocity);
}`;

const fragmentSource = `#version 300 es
precision mediump float;
in float speed;
uniform vec4 colour;   // a = 0: by speed
out vec4 painted;
void main() {
  vec2 at = 2.0 * gl_PointCoord - 1.0;
  float inside = 1.0 - dot(at, at);
  if (colour.a < 2.0 && inside < 0.0) discard;
  float light = colour.a < 2.0 ? 0.35 + 0.65 * sqrt(inside) * (1.0 - 0.35 * (at.x + at.y)) : 1.0;
  vec3 by_speed = mix(vec3(0.08, 0.33, 0.75), vec3(0.85, 0.95, 1.0), min(speed / 3.0, 1.0));
  painted = vec4((colour.a == 0.0 ? by_speed : colour.rgb) * light, 1.0);
}`;

function programOf(gl) {
  const program = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertexSource], [gl.FRAGMENT_SHADER, fragmentSource]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  return program;
}

function edgesOf([x, y, z]) {
  const corners = [[0, 0], [x, 0], [x, y], [0, y]];
  return new Float32Array(corners.flatMap(([a, b], k) => {
    const [c, d] = corners[(k + 1) % 4];
    return [a, b, 0, c, d, 0, a, b, z, c, d, z, a, b, 0, a, b, z];
  }));
}

export class Picture {
  constructor(canvas, tank) {
    this.gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    if (!this.gl) throw new Error("this browser has no WebGL2, which draws the particles");
    this.canvas = canvas;
    this.tank = tank;
    this.edges = edgesOf(tank);
    this.program = programOf(this.gl);
    this.places = this.gl.createBuffer();
    this.velocities = this.gl.createBuffer();
    this.eye = [tank[0] / 2, 0.6 * tank[1], tank[2] + 2.4];
  }

  // The size of the canvas, and how far lengths at distance 1 reach over it: the tank fills it with a margin.
  #zoom() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const distance = this.eye[2] - this.tank[2];
    const pixels = Math.min((0.9 * width) / this.tank[0], (0.75 * height) / this.tank[1]) * distance;
    return { width, height, pixels, zoom: [(2 * pixels) / width, (2 * pixels) / height] };
  }

  // Where a place of the page lies in the tank, at this depth.
  placeOf(clientX, clientY, depth) {
    const { width, height, pixels } = this.#zoom();
    const distance = this.eye[2] - depth;
    return [
      this.eye[0] + ((clientX - width / 2) * distance) / pixels,
      this.eye[1] - ((clientY - height / 2) * distance) / pixels,
      depth,
    ];
  }

  #points(positions, velocities, kind) {
    const { gl } = this;
    for (const [location, buffer, values] of [[0, this.places, positions], [1, this.velocities, velocities]]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      if (!values) {
        gl.disableVertexAttribArray(location);
        continue;
      }
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, 3, gl.FLOAT, false, 0, 0);
    }
    gl.drawArrays(kind, 0, positions.length / 3);
  }

  draw(solver, radius, ball) {
    const { gl, canvas } = this, { width, height, pixels, zoom } = this.#zoom(), ratio = devicePixelRatio;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const place = (name) => gl.getUniformLocation(this.program, name);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.enable(gl.DEPTH_TEST);
    gl.clearColor(0.063, 0.082, 0.11, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(this.program);
    gl.uniform3fv(place("eye"), this.eye);
    gl.uniform2fv(place("zoom"), zoom);
    gl.uniform1f(place("pixels"), pixels * ratio);
    gl.uniform1f(place("radius"), 1.1 * radius);
    gl.uniform4f(place("colour"), 0, 0, 0, 0);
    this.#points(solver.positions, solver.velocities, gl.POINTS);
    if (ball) {
      gl.uniform1f(place("radius"), ball.radius);
      gl.uniform4f(place("colour"), 0.95, 0.6, 0.25, 1);
      this.#points(new Float32Array(ball.place), null, gl.POINTS);
    }
    gl.uniform4f(place("colour"), 0.45, 0.52, 0.6, 2);
    this.#points(this.edges, null, gl.LINES);
  }
}
