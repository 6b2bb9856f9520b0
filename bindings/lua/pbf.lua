-- Position based fluids for LuaJIT: the C library pbf through its FFI. pbf.h says what each parameter and
-- call does; names are those there.
--
--   local pbf = require("pbf")
--   local fluid = pbf.solver { capacity = 4000, params = { domain_max = { 2, 1, 1 } } }
--   fluid:add { { 0.5, 0.5, 0.5 }, { 0.6, 0.5, 0.5 } }
--   fluid:step(10)
--   local x, count = fluid:positions()   -- float *, x[3 * i + c], or double *
--
-- Beside solvers there are pbf.shape_from_points and its like, pbf.load_shape, and pbf.batch.
--
-- A call that fails is a Lua error: a table with status, name and message, the library's sentence. A
-- solver is destroyed when it is collected, or by close().
--
-- The library is found as the system's loader finds libpbf, or is the file PBF_LIBRARY.
local ffi = require("ffi")
local core = require("pbf.core")
local C, call, new, need, unsigned = core.C, core.call, core.new, core.need, core.unsigned
local invalid, assign, run, rows_of, number_of = core.invalid, core.assign, core.run, core.rows_of, core.number_of

local shapes = require("pbf.shapes")

local pbf = { Error = core.Error }
-- pbf.COLLIDER_SPHERE is PBF_COLLIDER_SPHERE.
setmetatable(pbf, { __index = function(_, name) return C["PBF_" .. name] end })

local function params_from(fields)
  if type(fields) == "cdata" then
    if fields == nil or not ffi.istype("pbf_params", fields) then invalid("params is %s; it must be a table, or a pbf_params", tostring(fields)) end
    return fields
  end
  local params = new("pbf_params")
  call("pbf_params_init", params, ffi.sizeof(params))
  return assign("params", params, fields)
end

-- The parameters' defaults, with these changed: a pbf_params.
function pbf.params(fields) return params_from(fields) end

function pbf.version()
  local version = C.pbf_version()
  return string.format("%d.%d.%d", version / 1000000, version / 1000 % 1000, version % 1000)
end

-- Loads a plugin from an absolute path, for the life of the process: the code in it is run.
function pbf.load_backend(path)
  call("pbf_load_backend", core.c_string("path", need("string", "path", path, "an absolute path")))
end

-- Every backend found: tables of name, available, score, device_name, reason.
function pbf.backends()
  local count, found = ffi.new("uint32_t[1]"), {}
  call("pbf_get_backend_count", count)
  for index = 0, count[0] - 1 do
    local info = new("pbf_backend_info")
    call("pbf_get_backend_info", nil, index, info)
    found[#found + 1] = {
      name = ffi.string(info.name), available = info.available == 1, score = info.score,
      device_name = ffi.string(info.device_name), reason = ffi.string(info.reason),
    }
  end
  return found
end

-- ---- A solver ----

local Solver = {}
Solver.__index = Solver

-- Keeps errors out of the library, which they must not cross.
local function guarded(log, thrown)
  return ffi.cast("pbf_log_fn", function(_, level, message)
    local done, why = pcall(log, level, ffi.string(message))
    if not done and thrown.error == nil then thrown.error = why or "the log failed" end
  end)
end

-- A description from options, with what it names, and parameters; `others` are options that are not of pbf_desc.
local function described(options, others)
  local desc, kept, taken = new("pbf_desc"), {}, {}
  call("pbf_desc_init", desc, ffi.sizeof(desc))
  for name, value in pairs(need("table", "the description", options or {}, "a table")) do
    if others[name] then taken[name] = value
    elseif type(value) == "function" then -- whose error would leave a call of the library's halfway
      invalid("desc.%s is a function of Lua, which other threads would call, and LuaJIT runs in one; it must be one of C", tostring(name))
    else kept[name] = value end -- strings live on until the library has copied them
  end
  assign("desc", desc, kept)
  return desc, taken, kept
end

local function solver_of(handle, desc, rest)
  rest.handle, rest.what, rest.dimension = handle, "solver", desc.dimension
  rest.element = desc.precision == C.PBF_FLOAT64 and "double" or "float"
  return setmetatable(rest, Solver)
end

-- options: dimension, precision (pbf.FLOAT32, pbf.FLOAT64), capacity, strict, backend, device, threads, isa,
-- determinism (pbf.DETERMINISM_ACROSS_MACHINES, pbf.DETERMINISM_PER_MACHINE);
-- params: a table of what differs from the defaults; log: function(level, sentence).
function pbf.solver(options)
  local desc, taken, kept = described(options, { params = true, log = true })
  local made, thrown = ffi.new("pbf_solver *[1]"), {}
  local log = taken.log and need("function", "log", taken.log, "a function of level and sentence")
  local params = params_from(taken.params)
  local callback = log and guarded(log, thrown)
  desc.log = callback
  local done, why = pcall(call, "pbf_create", desc, params, made)
  core.alive(kept)
  if not done then
    if callback then callback:free() end
    error(why, 0)
  end
  local function destroy(solver)
    C.pbf_destroy(solver)
    if callback then callback:free() end
  end
  return solver_of(ffi.gc(made[0], destroy), desc, { destroy = destroy, thrown = thrown, has_log = log ~= nil })
end

-- Destroys it now. Nothing else can be called then; a second time does nothing. A world of a batch stays.
function Solver:close()
  local handle = self.handle
  if not handle then return end
  self.handle = nil
  core.when_left({ [self] = true }, function()
    if self.batch then
      C.pbf_cancel(handle) -- steps that have begun end
      C.pbf_end_step(handle)
    else
      self.destroy(ffi.gc(handle, nil))
    end
  end)
end

-- ---- Arrays ----

-- Gives the id of the first one. Without velocities they are at rest.
function Solver:add(positions, velocities, count)
  local x, rows = rows_of("positions", self.element, self.dimension, positions, count)
  local v, others
  if velocities then
    v, others = rows_of("velocities", self.element, self.dimension, velocities, count)
    if others ~= rows then invalid("velocities has %d rows, positions %d", others, rows) end
  end
  local first = ffi.new("uint32_t[1]")
  run(self, "pbf_add_particles", rows, x, v, first)
  return first[0]
end

function Solver:remove(ids, count)
  local array, rows = rows_of("ids", "uint32_t", 1, ids, count)
  run(self, "pbf_remove_particles", rows, array)
end

local function corner(what, values)
  need("table", what, values, "a table of numbers")
  local numbers = { values[1], values[2], values[3] or 0 }
  for axis = 1, 3 do need("number", string.format("%s[%d]", what, axis), numbers[axis], "a number") end
  return ffi.new("double[3]", numbers)
end

-- Gives how many they were.
function Solver:remove_in_box(lower, upper)
  local count = ffi.new("uint32_t[1]")
  run(self, "pbf_remove_in_box", corner("lower", lower), corner("upper", upper), count)
  return count[0]
end

-- Gives an array of ids, and how many.
function Solver:find_in_box(lower, upper)
  local room, count = self:count(), ffi.new("uint32_t[1]")
  local ids = ffi.new("uint32_t[?]", room)
  run(self, "pbf_find_in_box", corner("lower", lower), corner("upper", upper), room, ids, count)
  return ids, count[0]
end

function Solver:count() return number_of(self, "uint32_t", "pbf_get_count") end

-- Gives an array of C, and how many particles are in it.
local function reader(name, vector, element)
  return function(self)
    local count = self:count()
    local array = ffi.new((element or self.element) .. "[?]", count * (vector and self.dimension or 1))
    run(self, name, 0, count, array)
    return array, count
  end
end
Solver.positions, Solver.velocities = reader("pbf_get_positions", true), reader("pbf_get_velocities", true)
Solver.densities, Solver.pressures = reader("pbf_get_densities"), reader("pbf_get_pressures")
Solver.ids = reader("pbf_get_ids", false, "uint32_t")

-- Those of row `first` (0: the first one) and so on.
local function writer(name, what)
  return function(self, values, first, count)
    local array, rows = rows_of(what, self.element, self.dimension, values, count)
    run(self, name, unsigned("first", first or 0), rows, array)
    core.alive(values)
  end
end
Solver.set_positions, Solver.set_velocities = writer("pbf_set_positions", "positions"), writer("pbf_set_velocities", "velocities")

-- Beside gravity, of row `first` and so on, in each step until they are set anew; nil takes all away.
function Solver:set_accelerations(values, first, count)
  if values == nil then return run(self, "pbf_set_accelerations", 0, 0, nil) end
  local array, rows = rows_of("accelerations", self.element, self.dimension, values, count)
  run(self, "pbf_set_accelerations", unsigned("first", first or 0), rows, array)
end

-- Calls with a view of a field ("position", or pbf.FIELD_POSITION, …), a pbf_view, which is gone afterwards.
function Solver:map(field, with)
  if type(field) == "string" then
    local found, number = pcall(function() return C["PBF_FIELD_" .. field:upper()] end)
    field = found and number or invalid("the field is %q; known are: position, velocity, id, density, pressure", field)
  end
  field = unsigned("field", field)
  need("function", "what is called with the view", with, "a function")
  local view = new("pbf_view")
  run(self, "pbf_map", field, view)
  local handle = core.enter(self)
  local results = { pcall(with, view) }
  C.pbf_unmap(handle, field)
  ffi.fill(view, ffi.sizeof(view)) -- what keeps it finds no particles
  core.leave(self)
  if not results[1] then error(results[2], 0) end
  return unpack(results, 2, table.maxn(results))
end

-- ---- Steps and parameters ----

function Solver:step(steps) run(self, "pbf_step", unsigned("steps", steps or 1)) end

-- Steps beside other work; not with a log, which another thread would call.
function Solver:begin_step(steps)
  if self.has_log then invalid("a solver with a log can't begin steps: LuaJIT runs in one thread") end
  run(self, "pbf_begin_step", unsigned("steps", steps or 1))
end

function Solver:end_step() run(self, "pbf_end_step") end
function Solver:cancel() run(self, "pbf_cancel") end
function Solver:synchronize() run(self, "pbf_synchronize") end

-- What changes of the present ones: a table; or all: a pbf_params.
function Solver:set_params(fields)
  local params = type(fields) == "cdata" and params_from(fields) or assign("params", self:params(), fields)
  params.struct_size = ffi.sizeof("pbf_params")
  run(self, "pbf_set_params", params)
end

-- A list of tables: shape = "sphere", position = {…}, radius = … and so on, as pbf_collider has them; or shape is
-- one that pbf.shape_from_… has made.
function Solver:set_colliders(list)
  local array, count = shapes.colliders_of(list)
  run(self, "pbf_set_colliders", count, array)
  core.alive(list)
end

function Solver:move_colliders(list, duration)
  local array, count = shapes.colliders_of(list)
  run(self, "pbf_move_colliders", count, array,
    need("number", "duration", duration, "a number"))
  core.alive(list)
end

-- A list of tables, as set_colliders takes it.
function Solver:colliders()
  local list = {}
  for index = 0, number_of(self, "uint32_t", "pbf_get_collider_count") - 1 do
    local collider = new("pbf_collider")
    run(self, "pbf_get_collider", index, collider)
    list[#list + 1] = shapes.collider_from(collider, self.dimension)
  end
  return list
end

-- Gives an array of C of pbf_collider_load, from 0 on, and how many are in it.
local function loads_of(self, name, count)
  local array = ffi.new("pbf_collider_load[?]", math.max(count, 1))
  for i = 0, count - 1 do array[i].struct_size = ffi.sizeof("pbf_collider_load") end
  run(self, name, count, array)
  return array, count
end

-- What the fluid does to each collider, and begins their sums anew; wants params.loads.
function Solver:collider_loads()
  return loads_of(self, "pbf_get_collider_loads", number_of(self, "uint32_t", "pbf_get_collider_count"))
end

-- The same of the domain's walls, by pbf.WALL_X_MIN and so on.
function Solver:wall_loads() return loads_of(self, "pbf_get_wall_loads", 2 * self.dimension) end

local function report(name, struct)
  return function(self)
    local filled = new(struct)
    run(self, name, filled)
    return filled
  end
end
Solver.params, Solver.stats = report("pbf_get_params", "pbf_params"), report("pbf_get_stats", "pbf_stats")
Solver.info, Solver.plan = report("pbf_get_info", "pbf_info"), report("pbf_get_plan", "pbf_plan")
Solver.timings = report("pbf_get_timings", "pbf_timings")

function Solver:set_timing(enabled) run(self, "pbf_set_timing", enabled and 1 or 0) end

function Solver:step_limit() return number_of(self, "double", "pbf_get_step_limit") end

-- ---- State ----

-- A string that load takes.
function Solver:save()
  local size = ffi.new("uint64_t[1]")
  run(self, "pbf_save", nil, size)
  local buffer = ffi.new("uint8_t[?]", tonumber(size[0]))
  run(self, "pbf_save", buffer, size)
  return ffi.string(buffer, tonumber(size[0]))
end

function Solver:load(state)
  need("string", "the state", state, "a string that save has given")
  run(self, "pbf_load", state, #state)
end

function Solver:hash() return number_of(self, "uint64_t", "pbf_hash") end

function Solver:set_snapshots(snapshots) run(self, "pbf_set_snapshots", unsigned("snapshots", snapshots)) end

-- The state after the last step, a pbf_snapshot, which outlives the solver.
function Solver:snapshot()
  local snapshot = new("pbf_snapshot")
  run(self, "pbf_acquire_snapshot", snapshot)
  return ffi.gc(snapshot, function(held) C.pbf_release_snapshot(held) end)
end

-- ---- The other parts ----

for name, method in pairs(require("pbf.queries").methods) do Solver[name] = method end
for name, method in pairs(require("pbf.emission")) do Solver[name] = method end
for name, method in pairs(require("pbf.reading")) do Solver[name] = method end
for name, method in pairs(require("pbf.diffuse")) do Solver[name] = method end
for name, method in pairs(require("pbf.phases")) do Solver[name] = method end
pbf.shape_from_grid, pbf.shape_from_mesh = shapes.from_grid, shapes.from_mesh
pbf.shape_from_heights, pbf.shape_from_points = shapes.from_heights, shapes.from_points
pbf.load_shape = shapes.load
pbf.batch = require("pbf.batch")(described, params_from, solver_of)

return pbf
