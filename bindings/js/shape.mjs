// Solids of any form, and what colliders are of.
import { constants } from "./abi.g.mjs";
import { check, exports, invalid, named, numberOf, read, readNumber, withBytes, withRows, withStruct, withStructs } from "./module.mjs";

// What is collected without destroy() gives its reference back then.
const forgotten = new FinalizationRegistry((handle) => exports.pbf_release_shape(handle));

const HANDLE = Symbol("handle");

function described(where, options, known) {
  if (!exports) throw invalid("the module is not loaded; await load() first, or Solver.create()");
  for (const name of Object.keys(options)) {
    if (!known.includes(name)) throw invalid(`${where} has no ${name}; it has ${known.join(", ")}`);
  }
}

function dimensionOf(where, dimension) {
  if (dimension !== 2 && dimension !== 3) throw invalid(`${where} is ${String(dimension)}; it must be 2 or 3`);
  return dimension;
}

// How many numbers there must be, by counts along each axis.
function product(where, counts) {
  if (typeof counts?.length !== "number") throw invalid(`${where} is ${String(counts)}; it must be an array of numbers`);
  return Array.from(counts).reduce((all, count, k) => all * numberOf(`${where}[${k}]`, "u32", count), 1);
}

function made(create, dimension, name, where, values) {
  const handle = withStruct(name, where, { dimension, ...values }, (desc) => withBytes(4, (at) => {
    check(create(desc, at));
    return readNumber("u32", at);
  }));
  return new Shape({ [HANDLE]: handle, dimension });
}

/** A solid that colliders have: { shape: rock, position: […] }. It lives while this object or a solver has it. */
export class Shape {
  #handle;
  #dimension;

  /** Shape.fromPoints and its like make one. */
  constructor({ [HANDLE]: handle, dimension } = {}) {
    if (!handle) throw invalid("a shape is made by fromGrid, fromMesh, fromHeights, fromPoints or load");
    this.#handle = handle;
    this.#dimension = dimension;
    forgotten.register(this, handle, this);
  }

  /** Signed distances, negative inside, at origin + cell (i, j, k), the first index the fastest. */
  static fromGrid(grid) {
    described("grid", grid, ["nodes", "origin", "cell", "values"]);
    const { nodes, origin, cell, values } = grid, wanted = product("grid.nodes", nodes);
    const dimension = dimensionOf("the number of grid.nodes", nodes.length);
    return withRows("grid.values", values, 1, Float32Array, (at, rows) => {
      if (rows !== wanted) throw invalid(`grid.values has ${rows} numbers, of ${wanted} nodes`);
      return made(exports.pbf_shape_from_grid, dimension, "pbf_grid_desc", "grid", { nodes, origin, cell, values: at });
    });
  }

  /** What a closed surface of triangles encloses, in 2D a closed line of segments; with a thickness a shell. */
  static fromMesh(mesh) {
    described("mesh", mesh, ["dimension", "vertices", "faces", "cell", "thickness"]);
    const { vertices, faces, cell, thickness } = mesh, dimension = dimensionOf("mesh.dimension", mesh.dimension);
    for (const [k, index] of Array.from(faces ?? []).entries()) numberOf(`mesh.faces[${k}]`, "u32", index);
    return withRows("mesh.vertices", vertices, dimension, Float64Array, (places, vertexCount) =>
      withRows("mesh.faces", faces, dimension, Uint32Array, (numbers, faceCount) => made(
        exports.pbf_shape_from_mesh, dimension, "pbf_mesh_desc", "mesh", { vertexCount, faceCount, vertices: places, faces: numbers, cell, thickness })));
  }

  /** A terrain down to `base`; count has the numbers of heights along x and, in 3D, z. */
  static fromHeights(heights) {
    described("heights", heights, ["count", "heights", "spacing", "base", "cell"]);
    const { count, spacing, base, cell } = heights, wanted = product("heights.count", count);
    const dimension = dimensionOf("1 + the numbers of heights.count", 1 + count.length);
    return withRows("heights.heights", heights.heights, 1, Float64Array, (at, rows) => {
      if (rows !== wanted) throw invalid(`heights.heights has ${rows} numbers; by count it must have ${wanted}`);
      return made(exports.pbf_shape_from_heights, dimension, "pbf_heights_desc", "heights", { count, heights: at, spacing, base, cell });
    });
  }

  /** Their convex hull. */
  static fromPoints(hull) {
    described("hull", hull, ["dimension", "points", "cell"]);
    const { points, cell } = hull, dimension = dimensionOf("hull.dimension", hull.dimension);
    return withRows("hull.points", points, dimension, Float64Array, (at, pointCount) => made(
      exports.pbf_shape_from_points, dimension, "pbf_hull_desc", "hull", { pointCount, points: at, cell }));
  }

  /** Of bytes that save() or pbf-bake wrote. */
  static load(saved) {
    if (!exports) throw invalid("the module is not loaded; await load() first, or Solver.create()");
    if (!(saved instanceof Uint8Array)) throw invalid(`saved is ${String(saved)}; it must be a Uint8Array`);
    return withBytes(saved.length, (bytes) => withBytes(4, (at) => {
      new Uint8Array(exports.memory.buffer, bytes).set(saved);
      check(exports.pbf_load_shape(bytes, BigInt(saved.length), at));
      const handle = readNumber("u32", at);
      const { dimension } = withStruct("pbf_shape_info", "info", {}, (info) => {
        check(exports.pbf_get_shape_info(handle, info));
        return read("pbf_shape_info", info);
      });
      return new Shape({ [HANDLE]: handle, dimension });
    }));
  }

  /** As bytes, for a file. */
  save() {
    return withBytes(8, (size) => {
      check(exports.pbf_save_shape(this[HANDLE], 0, size));
      const bytes = readNumber("u64", size);
      return withBytes(bytes, (at) => {
        check(exports.pbf_save_shape(this[HANDLE], at, size));
        return new Uint8Array(exports.memory.buffer, at, bytes).slice();
      });
    });
  }

  /** The distances at its nodes, as fromGrid takes them. */
  get values() {
    const { nodes } = this.info;
    const count = nodes[0] * nodes[1] * (this.#dimension === 3 ? nodes[2] : 1);
    return withBytes(4 * count, (at) => {
      check(exports.pbf_get_shape_values(this[HANDLE], BigInt(count), at));
      return new Float32Array(exports.memory.buffer, at, count).slice();
    });
  }

  /** Gives its reference back now; solvers that have the shape keep it. */
  destroy() {
    if (!this.#handle) return;
    forgotten.unregister(this);
    exports.pbf_release_shape(this.#handle);
    this.#handle = 0;
  }

  [Symbol.dispose ?? Symbol.for("Symbol.dispose")]() {
    this.destroy();
  }

  /** For colliders. */
  get [HANDLE]() {
    if (!this.#handle) throw invalid("the shape is destroyed");
    return this.#handle;
  }

  get dimension() {
    return this.#dimension;
  }

  get info() {
    return withStruct("pbf_shape_info", "info", {}, (at) => {
      check(exports.pbf_get_shape_info(this[HANDLE], at));
      return read("pbf_shape_info", at);
    });
  }

  /** Of a point in the shape's own space: { distance, normal }, the direction in which it grows. */
  distance(point) {
    return withRows("point", point, this.#dimension, Float64Array, (x, rows) => {
      if (rows !== 1) throw invalid(`point has ${point.length} numbers; the shape is in ${this.#dimension}D`);
      return withBytes(32, (at) => {
        check(exports.pbf_get_shape_distance(this[HANDLE], x, at, at + 8));
        return { distance: readNumber("f64", at), normal: Array.from({ length: this.#dimension }, (_, k) => readNumber("f64", at + 8 + 8 * k)) };
      });
    });
  }
}

// ---- Colliders

const kinds = ["plane", "sphere", "capsule", "box"], kindOf = named(kinds);

/** Calls with how many there are, and where. */
export function withColliders(where, colliders, use) {
  return withStructs("pbf_collider", where, colliders, "pbf_collider_init",
    (place, shape) => (shape instanceof Shape ? [constants.COLLIDER_SHAPE, { geometry: shape[HANDLE] }] : kindOf(place, shape)), use);
}

/** As setColliders takes it. */
export function colliderFrom({ geometry, ...values }, dimension) {
  if (values.shape !== constants.COLLIDER_SHAPE) return { ...values, shape: kinds[values.shape] };
  check(exports.pbf_hold_shape(geometry));
  return { ...values, shape: new Shape({ [HANDLE]: geometry, dimension }) };
}
