-- Position based fluids for LuaJIT: the C library pbf through its FFI. pbf.h says what each parameter and
-- call does; names are those there.
--
--   local pbf = require("pbf")
--   local fluid = pbf.solver { capacity = 4000, params = { domain_max = { 2, 1, 1 } } }
--   fluid:add { { 0.5, 0.5, 0.5 }, { 0.6, 0.5, 0.5 } }
--   fluid:step(10)
--   local x, count = fluid:positions()   -- float *, x[3 * i + c], or double *
--
-- A call that fails is a Lua error: a table with status, name and message, the library's sentence. A
-- solver is destroyed when it is collected, or by close().
--
-- The library is found as the system's loader finds libpbf, or is the file PBF_LIBRARY.
local ffi = require("ffi")
require("pbf.cdef")

local function load_library()
  local named = os.getenv("PBF_LIBRARY")
  if named then return ffi.load(named) end
  local found, library = pcall(ffi.load, "pbf")
  return found and library or ffi.load("libpbf.so.0.2") -- without its development files
end
local C = load_library()

local pbf = {}
-- pbf.COLLIDER_SPHERE is PBF_COLLIDER_SPHERE.
setmetatable(pbf, { __index = function(_, name) return C["PBF_" .. name] end })

local Error = {}
Error.__index = Error
Error.__tostring = function(self) return self.message end
pbf.Error = Error

local function fail(status, message)
  error(setmetatable({ status = status, name = ffi.string(C.pbf_status_string(status)), message = message }, Error), 0)
end

local function invalid(...) fail(C.PBF_ERROR_INVALID_ARGUMENT, string.format(...)) end

-- Not compiled: what it calls may call the log, and a compiled trace can't be called back into.
local function call(name, ...)
  local status = C[name](...)
  if status ~= 0 then fail(status, ffi.string(C.pbf_last_error())) end
end
jit.off(call)

-- A new struct, with its size.
local function new(struct) return ffi.new(struct, { struct_size = ffi.sizeof(struct) }) end

local function shown(value)
  return type(value) == "string" and string.format("%q", value) or tostring(value)
end

local function need(kind, what, value, wanted)
  if type(value) ~= kind then invalid("%s is %s; it must be %s", what, shown(value), wanted) end
  return value
end

-- LuaJIT makes some integer of any number: 2^32 - 1 of -1.
local function unsigned(what, value)
  local number = type(value) == "cdata" and tonumber(value) or value
  if type(number) ~= "number" or number % 1 ~= 0 or number < 0 or number > 4294967295 then
    invalid("%s is %s; it must be an integer, 0 … 4294967295", what, shown(value))
  end
  return number
end

-- Puts a value where C has a field or an element. What does not come back as it was given does not fit there.
local function put(what, place, name, value)
  local done = pcall(function() place[name] = value end)
  if not done then invalid("%s is %s, which is no value for it", what, shown(value)) end
  local kept = place[name]
  if type(value) == "number" and type(kept) == "number" and kept ~= value and (kept == kept or value == value) then
    invalid("%s is %s; it must be an integer that its field can hold", what, shown(value))
  end
end

-- How many elements a field has that is an array, from the name of its type; else nil.
local function array_length(field)
  return type(field) == "cdata" and tonumber(tostring(ffi.typeof(field)):match("%[(%d+)%]")) or nil
end

-- Fields of a struct from a table; `what` is what the library calls the struct.
local function assign(what, struct, fields)
  if fields == nil then return struct end
  for name, value in pairs(need("table", what, fields, "a table")) do
    local field = what .. "." .. tostring(name)
    if type(name) ~= "string" or not ffi.offsetof(struct, name) then invalid("there is no %s", field) end
    local length = array_length(struct[name])
    if length and type(value) ~= "cdata" then
      need("table", field, value, string.format("a table of at most %d numbers", length))
      if #value > length then invalid("%s has %d numbers, and at most %d", field, #value, length) end
      for i = 1, #value do put(string.format("%s[%d]", field, i), struct[name], i - 1, value[i]) end
    else
      put(field, struct, name, value)
    end
  end
  return struct
end

local function params_from(fields)
  if type(fields) == "cdata" then return fields end
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

-- Calls with the solver; an error of the log goes on when the call has returned.
local function run(self, name, ...)
  if not self.handle then invalid("the solver is closed") end
  local done, why = pcall(call, name, self.handle, ...)
  local thrown = self.thrown.error
  self.thrown.error = nil
  if not done then error(why, 0) end
  if thrown ~= nil then error(thrown, 0) end
end

-- Keeps errors out of the library, which they must not cross.
local function guarded(log, thrown)
  return ffi.cast("pbf_log_fn", function(_, level, message)
    local done, why = pcall(log, level, ffi.string(message))
    if not done and thrown.error == nil then thrown.error = why or "the log failed" end
  end)
end

-- options: dimension, precision (pbf.FLOAT32, pbf.FLOAT64), capacity, strict, backend, device, threads, isa;
-- params: a table of what differs from the defaults; log: function(level, sentence).
function pbf.solver(options)
  local desc, made, kept, thrown = new("pbf_desc"), ffi.new("pbf_solver *[1]"), {}, {}
  call("pbf_desc_init", desc, ffi.sizeof(desc))
  local params, log
  for name, value in pairs(need("table", "the description", options or {}, "a table")) do
    if name == "params" then params = value
    elseif name == "log" then log = need("function", "log", value, "a function of level and sentence")
    else kept[name] = value end -- strings live on until the library has copied them, in pbf_create
  end
  assign("desc", desc, kept)
  params = params_from(params)
  local callback = log and guarded(log, thrown)
  desc.log = callback
  local done, why = pcall(call, "pbf_create", desc, params, made)
  if not done then
    if callback then callback:free() end
    error(why, 0)
  end
  local function destroy(solver)
    C.pbf_destroy(solver)
    if callback then callback:free() end
  end
  return setmetatable({
    handle = ffi.gc(made[0], destroy), destroy = destroy, thrown = thrown, has_log = log ~= nil, dimension = desc.dimension,
    element = desc.precision == C.PBF_FLOAT64 and "double" or "float",
  }, Solver)
end

-- Destroys it now. Nothing else can be called then; a second time does nothing.
function Solver:close()
  local handle = self.handle
  if not handle then return end
  self.handle = nil
  self.destroy(ffi.gc(handle, nil))
end

-- ---- Arrays ----

local function flat(values)
  if type(values[1]) ~= "table" then return values end
  local numbers = {}
  for _, row in ipairs(values) do
    for _, number in ipairs(row) do numbers[#numbers + 1] = number end
  end
  return numbers
end

-- A C array and how many rows it has, of a table of numbers, of tables of numbers, or of an array of C with
-- its number of rows.
local function rows_of(what, element, components, values, count)
  if type(values) == "cdata" then
    if not count then invalid("%s is an array of C: how many rows has it?", what) end
    return ffi.cast(string.format("const %s *", element), values), unsigned("count", count)
  end
  local numbers = flat(need("table", what, values, "a table, or an array of C"))
  for i, number in ipairs(numbers) do
    if element == "uint32_t" then unsigned(string.format("%s[%d]", what, i), number)
    else need("number", string.format("a number of %s", what), number, "a number") end
  end
  if #numbers % components ~= 0 then
    invalid("%s has %d numbers, no multiple of %d", what, #numbers, components)
  end
  return ffi.new(element .. "[?]", #numbers, numbers), #numbers / components
end

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

function Solver:count()
  local count = ffi.new("uint32_t[1]")
  run(self, "pbf_get_count", count)
  return count[0]
end

for _, name in ipairs { "positions", "velocities", "densities", "pressures", "ids" } do
  local vector = name == "positions" or name == "velocities"
  -- Gives an array of C, and how many particles are in it.
  Solver[name] = function(self)
    local count = self:count()
    local element = name == "ids" and "uint32_t" or self.element
    local array = ffi.new(element .. "[?]", count * (vector and self.dimension or 1))
    run(self, "pbf_get_" .. name, 0, count, array)
    return array, count
  end
  if vector then
    -- Those of row `first` (0: the first one) and so on.
    Solver["set_" .. name] = function(self, values, first, count)
      local array, rows = rows_of(name, self.element, self.dimension, values, count)
      run(self, "pbf_set_" .. name, unsigned("first", first or 0), rows, array)
    end
  end
end

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
  local results = { pcall(with, view) }
  run(self, "pbf_unmap", field)
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
  local params = type(fields) == "cdata" and fields or assign("params", self:params(), fields)
  params.struct_size = ffi.sizeof("pbf_params")
  run(self, "pbf_set_params", params)
end

local colliders = { plane = "PLANE", sphere = "SPHERE", capsule = "CAPSULE", box = "BOX" }

local function colliders_of(list)
  need("table", "colliders", list, "a list of tables")
  local array = ffi.new("pbf_collider[?]", math.max(#list, 1))
  for i, fields in ipairs(list) do
    local copy, what = {}, string.format("colliders[%d]", i)
    need("table", what, fields, "a table")
    for name, value in pairs(fields) do copy[name] = value end
    local shape = copy.shape
    if not colliders[shape] then
      invalid("colliders[%d].shape is %s; known are: plane, sphere, capsule, box", i, tostring(shape))
    end
    copy.shape = nil
    call("pbf_collider_init", array[i - 1], ffi.sizeof("pbf_collider"), C["PBF_COLLIDER_" .. colliders[shape]])
    assign(what, array[i - 1], copy)
  end
  return array, #list
end

-- A list of tables: shape = "sphere", position = {…}, radius = … and so on, as pbf_collider has them.
function Solver:set_colliders(list)
  local array, count = colliders_of(list)
  run(self, "pbf_set_colliders", count, array)
end

function Solver:move_colliders(list, duration)
  local array, count = colliders_of(list)
  run(self, "pbf_move_colliders", count, array,
    need("number", "duration", duration, "a number"))
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
  local count = ffi.new("uint32_t[1]")
  run(self, "pbf_get_collider_count", count)
  return loads_of(self, "pbf_get_collider_loads", count[0])
end

-- The same of the domain's walls, by pbf.WALL_X_MIN and so on.
function Solver:wall_loads() return loads_of(self, "pbf_get_wall_loads", 2 * self.dimension) end

for method, struct in pairs { params = "pbf_params", stats = "pbf_stats", info = "pbf_info", plan = "pbf_plan",
                              timings = "pbf_timings" } do
  Solver[method] = function(self)
    local filled = new(struct)
    run(self, "pbf_get_" .. method, filled)
    return filled
  end
end

function Solver:set_timing(enabled) run(self, "pbf_set_timing", enabled and 1 or 0) end

function Solver:step_limit()
  local limit = ffi.new("double[1]")
  run(self, "pbf_get_step_limit", limit)
  return limit[0]
end

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

function Solver:hash()
  local hash = ffi.new("uint64_t[1]")
  run(self, "pbf_hash", hash)
  return hash[0]
end

function Solver:set_snapshots(snapshots) run(self, "pbf_set_snapshots", unsigned("snapshots", snapshots)) end

-- The state after the last step, a pbf_snapshot, which outlives the solver.
function Solver:snapshot()
  local snapshot = new("pbf_snapshot")
  run(self, "pbf_acquire_snapshot", snapshot)
  return ffi.gc(snapshot, function(held) C.pbf_release_snapshot(held) end)
end

return pbf
