-- Solids of any form, and what colliders are of. pbf.shape_from_points { points = …, dimension = 3, cell = 0.02 } and its
-- like give a shape: `shape = rock` of a collider. It lives while the shape, a collider's table or a solver has it.
local ffi = require("ffi")
local core = require("pbf.core")
local C, call, new, need, invalid, rows_of = core.C, core.call, core.new, core.need, core.invalid, core.rows_of

local Shape = {}
Shape.__index = Shape

local function shape_of(handle, dimension)
  return setmetatable({ handle = ffi.gc(handle, C.pbf_release_shape), what = "shape", dimension = dimension }, Shape)
end

-- Gives its reference back now; solvers that have the shape keep it.
function Shape:close()
  if self.handle then C.pbf_release_shape(ffi.gc(self.handle, nil)) end
  self.handle = nil
end

-- A pbf_shape_info.
function Shape:info()
  local info = new("pbf_shape_info")
  core.run(self, "pbf_get_shape_info", info)
  return info
end

-- Of a point in the shape's own space, and the direction in which it grows: an array of C.
function Shape:distance(point)
  local at, rows = rows_of("point", "double", self.dimension, point, 1)
  if rows ~= 1 then invalid("point has %d numbers; the shape is in %dD", rows * self.dimension, self.dimension) end
  local distance, normal = ffi.new("double[1]"), ffi.new("double[3]")
  core.run(self, "pbf_get_shape_distance", at, distance, normal)
  return distance[0], normal
end

-- The distances at its nodes, as from_grid takes them, an array of C; and how many they are.
function Shape:values()
  local nodes = self:info().nodes
  local count = nodes[0] * nodes[1] * (self.dimension == 3 and nodes[2] or 1)
  local values = ffi.new("float[?]", count)
  core.run(self, "pbf_get_shape_values", count, values)
  return values, count
end

-- As bytes, for a file: a string.
function Shape:save()
  local size = ffi.new("uint64_t[1]")
  core.run(self, "pbf_save_shape", nil, size)
  local buffer = ffi.new("uint8_t[?]", tonumber(size[0]))
  core.run(self, "pbf_save_shape", buffer, size)
  return ffi.string(buffer, tonumber(size[0]))
end

local function dimension_of(what, dimension)
  if dimension ~= 2 and dimension ~= 3 then invalid("%s is %s; it must be 2 or 3", what, tostring(dimension)) end
  return dimension
end

-- A struct of C from options: `arrays` are those that are arrays of rows, (element, numbers a row) each, whose
-- numbers of rows are the second result; all else are fields.
local function described(struct, what, options, arrays)
  local desc, rows, fields, kept = new(struct), {}, {}, {}
  for name, value in pairs(need("table", what, options, "a table")) do
    if arrays[name] then
      kept[name], rows[name] = rows_of(what .. "." .. name, arrays[name][1], arrays[name][2], value, options.count_of and options.count_of[name])
      desc[name] = kept[name]
    elseif name ~= "count_of" then
      fields[name] = value
    end
  end
  for name in pairs(arrays) do
    if not rows[name] then invalid("there is no %s.%s", what, name) end
  end
  core.assign(what, desc, fields)
  return desc, rows, { kept, options }
end

local function made(name, desc, kept)
  local shape = ffi.new("pbf_shape *[1]")
  call(name, desc, shape)
  core.alive(kept)
  return shape_of(shape[0], desc.dimension)
end

local function product(counts, what)
  local numbers = 1
  for _, count in ipairs(need("table", what, counts, "a table of numbers")) do numbers = numbers * core.unsigned(what, count) end
  return numbers
end

local shapes = {}

-- { nodes = {…}, origin = {…}, cell = …, values = … }: signed distances, the first index the fastest. In this and the
-- next ones arrays are tables, or arrays of C with their numbers of rows in count_of.
function shapes.from_grid(options)
  local desc, rows, kept = described("pbf_grid_desc", "grid", options, { values = { "float", 1 } })
  desc.dimension = dimension_of("the number of grid.nodes", #need("table", "grid.nodes", options.nodes, "a table"))
  local wanted = product(options.nodes, "grid.nodes")
  if rows.values ~= wanted then invalid("grid.values has %d numbers, of %d nodes", rows.values, wanted) end
  return made("pbf_shape_from_grid", desc, kept)
end

-- { dimension = 3, vertices = …, faces = …, cell = … }, faces by numbers of vertices, the first one 0; with a thickness
-- a shell.
function shapes.from_mesh(options)
  local dimension = dimension_of("mesh.dimension", need("table", "mesh", options, "a table").dimension)
  local desc, rows, kept = described("pbf_mesh_desc", "mesh", options,
    { vertices = { "double", dimension }, faces = { "uint32_t", dimension } })
  desc.vertex_count, desc.face_count = rows.vertices, rows.faces
  return made("pbf_shape_from_mesh", desc, kept)
end

-- { count = {…}, heights = …, spacing = …, base = …, cell = … }: count along x and, in 3D, z.
function shapes.from_heights(options)
  local desc, rows, kept = described("pbf_heights_desc", "heights", options, { heights = { "double", 1 } })
  desc.dimension = dimension_of("1 + the numbers of heights.count", 1 + #need("table", "heights.count", options.count, "a table"))
  local wanted = product(options.count, "heights.count")
  if rows.heights ~= wanted then invalid("heights.heights has %d numbers; by count it must have %d", rows.heights, wanted) end
  return made("pbf_shape_from_heights", desc, kept)
end

-- { dimension = 3, points = …, cell = … }: their convex hull.
function shapes.from_points(options)
  local dimension = dimension_of("hull.dimension", need("table", "hull", options, "a table").dimension)
  local desc, rows, kept = described("pbf_hull_desc", "hull", options, { points = { "double", dimension } })
  desc.point_count = rows.points
  return made("pbf_shape_from_points", desc, kept)
end

-- Of a string that save or pbf-bake wrote.
function shapes.load(saved)
  need("string", "the saved shape", saved, "a string that save has given")
  local shape, info = ffi.new("pbf_shape *[1]"), new("pbf_shape_info")
  call("pbf_load_shape", saved, #saved, shape)
  call("pbf_get_shape_info", shape[0], info)
  return shape_of(shape[0], info.dimension)
end

-- ---- Colliders ----

local kinds, name_of = core.named { "plane", "sphere", "capsule", "box" }

local function kind_of(what, shape)
  if getmetatable(shape) ~= Shape then return kinds(what, shape) end
  if not shape.handle then invalid("%s is closed", what) end
  return C.PBF_COLLIDER_SHAPE, { geometry = shape.handle }
end

-- An array of C, and how many are in it, while the list is kept.
function shapes.colliders_of(list) return core.structs_of("colliders", "pbf_collider", "pbf_collider_init", kind_of, list) end

-- A table as those are.
function shapes.collider_from(collider, dimension)
  local fields = core.fields_of("pbf_collider", collider)
  fields.geometry = nil
  if collider.shape == C.PBF_COLLIDER_SHAPE then
    call("pbf_hold_shape", collider.geometry)
    fields.shape = shape_of(collider.geometry, dimension)
  else
    fields.shape = name_of(collider.shape)
  end
  return fields
end

return shapes
