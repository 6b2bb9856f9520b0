-- Many worlds of one kind in one call. Arrays are world after world; a mask is a list of truth values, one a world, and nil
-- is all of them. Where a world fails the others go on, and the error is what the first one met.
local ffi = require("ffi")
local core = require("pbf.core")
local C, call, new, need, unsigned = core.C, core.call, core.new, core.need, core.unsigned
local invalid, run, rows_of = core.invalid, core.run, core.rows_of

local Batch = {}
Batch.__index = Batch

local function mask_of(self, mask)
  if mask == nil then return nil end
  if #need("table", "mask", mask, "a list of truth values") ~= self.worlds then
    invalid("mask has %d values, of %d worlds", #mask, self.worlds)
  end
  local bytes = ffi.new("uint8_t[?]", self.worlds)
  for i, chosen in ipairs(mask) do bytes[i - 1] = chosen and chosen ~= 0 and 1 or 0 end
  return bytes
end

local function each_world(self, what, rows, each)
  if rows ~= self.worlds * each then invalid("%s has %d rows, not as many for each of %d worlds", what, rows, self.worlds) end
end

-- Destroys it now, and its worlds. Nothing else can be called then; a second time does nothing.
function Batch:close()
  local handle = self.handle
  if not handle then return end
  self.handle = nil
  for world in pairs(self.given) do world.handle = nil end
  core.when_left(self.given, function() C.pbf_batch_destroy(ffi.gc(handle, nil)) end)
end

-- A pbf_batch_info.
function Batch:info()
  local info = new("pbf_batch_info")
  run(self, "pbf_batch_get_info", info)
  return info
end

-- World 0 and so on as a solver, between calls of the batch.
function Batch:world(world)
  local found = ffi.new("pbf_solver *[1]")
  run(self, "pbf_batch_get_world", unsigned("world", world), found)
  local solver = self.solver_of(found[0], { batch = self, has_log = false })
  self.given[solver] = true
  return solver
end

-- A table of the errors of those worlds that failed in the last call that went through worlds, by their numbers.
function Batch:failures()
  local statuses, sentence, failures = ffi.new("pbf_status[?]", self.worlds), ffi.new("const char *[1]"), {}
  run(self, "pbf_batch_get_statuses", statuses)
  for world = 0, self.worlds - 1 do
    if statuses[world] ~= 0 then
      run(self, "pbf_batch_get_sentence", world, sentence)
      failures[world] = core.failure(statuses[world], ffi.string(sentence[0]))
    end
  end
  return failures
end

function Batch:step(steps, mask) run(self, "pbf_batch_step", mask_of(self, mask), unsigned("steps", steps or 1)) end

-- What reset goes back to: a state of save, or, for nil, the present one of each.
function Batch:set_start(state, mask)
  if state ~= nil then need("string", "the state", state, "a string that save has given") end
  run(self, "pbf_batch_set_start", mask_of(self, mask), state, state and #state or 0)
end

function Batch:reset(mask) run(self, "pbf_batch_reset", mask_of(self, mask)) end

-- Three numbers a world.
function Batch:set_gravity(gravity, mask, count)
  local array, rows = rows_of("gravity", "double", 3, gravity, count)
  each_world(self, "gravity", rows, 1)
  run(self, "pbf_batch_set_gravity", mask_of(self, mask), array)
  core.alive(gravity)
end

-- The same ones for all.
function Batch:set_colliders(list, mask)
  local array, count = require("pbf.shapes").colliders_of(list)
  run(self, "pbf_batch_set_colliders", mask_of(self, mask), count, array)
  core.alive(list)
end

-- All that each world has, world after world: three numbers each, and four of an orientation, or nil: they keep theirs.
function Batch:move_colliders(positions, duration, orientations, mask, count)
  local places, rows = rows_of("positions", "double", 3, positions, count)
  local each = math.floor(rows / self.worlds)
  each_world(self, "positions", rows, each)
  local turns, others
  if orientations then
    turns, others = rows_of("orientations", "double", 4, orientations, count)
    each_world(self, "orientations", others, each)
  end
  run(self, "pbf_batch_move_colliders", mask_of(self, mask), each, places, turns,
    need("number", "duration", duration, "a number"))
  core.alive(positions, orientations)
end

-- So many to each world; without velocities they are at rest.
function Batch:add(counts, positions, velocities, rows)
  local numbers, worlds = rows_of("counts", "uint32_t", 1, counts, self.worlds)
  each_world(self, "counts", worlds, 1)
  local wanted = 0
  for world = 0, self.worlds - 1 do wanted = wanted + numbers[world] end
  local x, has = rows_of("positions", self.element, self.dimension, positions, rows)
  local v, others
  if velocities then v, others = rows_of("velocities", self.element, self.dimension, velocities, rows) end
  if has ~= wanted or (others or wanted) ~= wanted then
    invalid("there are %d positions and %d velocities; by counts there must be %d", has, others or wanted, wanted)
  end
  run(self, "pbf_batch_add_particles", numbers, x, v)
  core.alive(counts, positions, velocities)
end

-- An array of how many particles each world has.
function Batch:counts()
  local counts = ffi.new("uint32_t[?]", self.worlds)
  run(self, "pbf_batch_get_counts", counts)
  return counts
end

-- A field ("position", "velocity", "density", "pressure" or "id") of each world: an array of shape (worlds, rows, components)
-- and its rows, as many as the world has that has most; rows that a world lacks are 0.
function Batch:read(field, mask)
  local fields = { position = C.PBF_FIELD_POSITION, velocity = C.PBF_FIELD_VELOCITY, density = C.PBF_FIELD_DENSITY,
                   pressure = C.PBF_FIELD_PRESSURE, id = C.PBF_FIELD_ID }
  if not fields[field] then
    invalid("the field is %s; known are: position, velocity, density, pressure, id", tostring(field))
  end
  local read, rows, counts = new("pbf_read_desc"), 0, self:counts()
  for world = 0, self.worlds - 1 do rows = math.max(rows, counts[world]) end
  local width = (field == "position" or field == "velocity") and self.dimension or 1
  local array = ffi.new((field == "id" and "uint32_t" or self.element) .. "[?]", math.max(1, self.worlds * rows * width))
  read.field, read.count, read.data = fields[field], rows, array
  run(self, "pbf_batch_read", mask_of(self, mask), read, 0)
  return array, rows
end

-- options are those of pbf.solver, and worlds; there is no log, which the batch's threads would call.
return function(described, params_from, solver_of)
  return function(options)
    local desc, taken, kept = described(options, { params = true, worlds = true, log = true })
    if taken.log ~= nil then invalid("a batch can't have a log: its threads would call it, and LuaJIT runs in one") end
    local worlds, made = unsigned("worlds", taken.worlds), ffi.new("pbf_batch *[1]")
    call("pbf_batch_create", desc, params_from(taken.params), worlds, made)
    core.alive(kept)
    return setmetatable({
      handle = ffi.gc(made[0], C.pbf_batch_destroy), what = "batch", worlds = worlds, dimension = desc.dimension,
      element = desc.precision == C.PBF_FLOAT64 and "double" or "float", given = setmetatable({}, { __mode = "k" }),
      solver_of = function(handle, rest) return solver_of(handle, desc, rest) end,
    }, Batch)
  end
end
