-- The LuaJIT module against the library; the backend is that of PBF_TEST_BACKEND, or "auto".
local ffi = require("ffi")
local pbf = require("pbf")

local backend = os.getenv("PBF_TEST_BACKEND") or "auto"

local function solver(options)
  options = options or {}
  options.backend, options.capacity, options.threads = backend, options.capacity or 100, 2
  return pbf.solver(options)
end

local function filled()
  local fluid = solver()
  assert(fluid:add { { 0.5, 0.5, 0.5 }, { 0.6, 0.5, 0.5 } } == 0)
  return fluid
end

local function near(a, b, bound) assert(math.abs(a - b) <= bound, a .. " is not " .. b) end

local function refused(name, words, call, ...)
  local done, why = pcall(call, ...)
  assert(not done, "nothing was refused")
  assert(type(why) == "table" and why.name == name, tostring(why) .. " is no " .. name)
  assert(tostring(why):find(words, 1, true), string.format("%q lacks %q", tostring(why), words))
end

local tests = {}

-- A view's memory stays until what was called with it has returned, and a log until its call has.
function tests.closed_in_a_call()
  local fluid, kept, calls = filled(), {}, 0
  fluid:map("position", function(view)
    fluid:close()
    fluid:close()
    for i = 1, 20 do kept[i] = filled() end -- in memory that was given back, if it was
    local x = ffi.cast("const float *", view.data)
    near(x[0], 0.5, 1e-6)
    near(x[view.particle_stride / 4], 0.6, 1e-6)
    refused("PBF_ERROR_INVALID_ARGUMENT", "closed", fluid.step, fluid)
  end)
  local batch = pbf.batch { backend = backend, capacity = 100, worlds = 2 }
  batch:add({ 1, 1 }, { { 0.5, 0.5, 0.5 }, { 0.25, 0.5, 0.5 } })
  local world, other = batch:world(1), batch:world(0)
  world:map("position", function(view)
    other:map("position", function(below)
      batch:close()
      for i = 1, 20 do kept[i] = filled() end
      near(ffi.cast("const float *", below.data)[0], 0.5, 1e-6)
    end)
    near(ffi.cast("const float *", view.data)[0], 0.25, 1e-6)
  end)
  refused("PBF_ERROR_INVALID_ARGUMENT", "closed", world.step, world)
  fluid = solver { params = { time_step = 0.5, attraction = 20 }, -- too long for both, and each is logged
    log = function()
      calls = calls + 1
      fluid:close()
      for i = 1, 20 do kept[i] = solver { log = function() error("another one's log") end } end
    end }
  fluid:add { { 0.5, 0.5, 0.5 } }
  fluid:step()
  assert(calls == 2, calls)
  refused("PBF_ERROR_INVALID_ARGUMENT", "closed", fluid.step, fluid)
end

function tests.strings_have_no_zero()
  refused("PBF_ERROR_INVALID_ARGUMENT", "desc.backend has a zero", pbf.solver, { backend = backend .. "\0x" })
  refused("PBF_ERROR_INVALID_ARGUMENT", "path has a zero", pbf.load_backend, "/tmp\0x")
  refused("PBF_ERROR_INVALID_ARGUMENT", "params is cdata", pbf.solver, { params = ffi.new("pbf_desc") })
  refused("PBF_ERROR_INVALID_ARGUMENT", "params is cdata", filled().set_params, filled(), ffi.new("int[1]"))
end

function tests.structs_lie_as_in_c()
  local structs = 0
  for struct, layout in pairs(require("pbf.cdef")) do
    structs = structs + 1
    for field, offset in pairs(layout) do
      local found = field == "size" and ffi.sizeof(struct) or ffi.offsetof(struct, field)
      assert(found == offset, string.format("%s.%s: %s, not %d", struct, field, tostring(found), offset))
    end
  end
  assert(structs > 10)
end

function tests.a_particle_falls()
  local fluid = solver { precision = pbf.FLOAT64, params = { time_step = 1 / 128 } }
  fluid:add { 0.5, 0.5, 0.5 }
  fluid:step(16)
  -- n steps of symplectic Euler: g dt^2 n (n + 1) / 2
  local g = fluid:params().gravity[1]
  local x, count = fluid:positions()
  assert(count == 1)
  near(x[1], 0.5 + g / 128 ^ 2 * 16 * 17 / 2, 1e-9)
  near(fluid:velocities()[1], g / 8, 1e-9)
  assert(fluid:info().step == 16 and fluid:stats().count == 1)
  local ids, found = fluid:find_in_box({ 0, 0, 0 }, { 1, 1, 1 })
  assert(found == 1 and ids[0] == 0)
  assert(fluid:remove_in_box({ 0, 0, 0 }, { 1, 1, 1 }) == 1 and fluid:count() == 0)
end

-- What walls and colliders have had is the momentum that gravity gave and the fluid has not.
function tests.loads_are_the_momentum_that_is_gone()
  local fluid = solver { precision = pbf.FLOAT64, params = { loads = 1 } }
  assert(select(2, fluid:collider_loads()) == 0)
  fluid:add { { 0.5, 0.06, 0.5 }, { 0.56, 0.06, 0.5 } }
  fluid:set_colliders { { shape = "sphere", position = { 0.9, 0.9, 0.9 }, radius = 0.05 } }
  fluid:step(16)
  local far, colliders = fluid:collider_loads()
  local walls, sides = fluid:wall_loads()
  assert(colliders == 1 and sides == 6)
  local v, params = fluid:velocities(), fluid:params()
  local volume, time = (params.smoothing_radius / 2) ^ 3, 16 * params.time_step
  local gone = volume * (2 * params.gravity[1] * time - v[1] - v[4])
  assert(gone < -0.5 * volume)
  near(walls[pbf.WALL_Y_MIN].impulse_sum[1] / gone, 1, 1e-9)
  near(walls[pbf.WALL_Y_MIN].time_sum, time, 1e-12)
  assert(far[0].contacts == 0 and far[0].impulse_sum[1] == 0)
  fluid:set_params { loads = 0 }
  refused("PBF_ERROR_STATE", "loads", fluid.wall_loads, fluid)
end

function tests.accelerations_hold_up()
  local fluid = filled()
  fluid:set_accelerations({ 0, 9.81, 0 }, 1)
  fluid:step(12)
  local v = fluid:velocities()
  near(v[1], -0.981, 1e-4)
  near(v[4], 0, 1e-6)
  local saved = fluid:save()
  refused("PBF_ERROR_INVALID_ARGUMENT", "accelerations has 2", fluid.set_accelerations, fluid, { 0, 1 })
  fluid:set_accelerations(nil)
  fluid:step(12)
  near(fluid:velocities()[4], -0.981, 1e-4)
  fluid:load(saved)
  fluid:step(12)
  near(fluid:velocities()[4], 0, 1e-5)
end

function tests.errors_have_the_sentence()
  local wrong = "PBF_ERROR_INVALID_ARGUMENT"
  refused(wrong, "time_step", solver, { params = { time_step = -1 } })
  refused(wrong, "dimension", solver, { dimension = 4 })
  local fluid = filled()
  refused(wrong, "4 numbers", fluid.add, fluid, { 1, 2, 3, 4 })
  refused(wrong, "velocities", fluid.add, fluid, { 0.5, 0.5, 0.5 }, { 0, 0, 0, 0, 0, 0 })
  refused(wrong, "NaN", fluid.add, fluid, { 0 / 0, 0.5, 0.5 })
  refused("PBF_ERROR_NOT_FOUND", "7", fluid.remove, fluid, { 7 })
  refused("PBF_ERROR_DATA", "", fluid.load, fluid, "water")
  refused(wrong, "cube", fluid.set_colliders, fluid, { { shape = "cube" } })
  refused(wrong, "time_stop", solver, { params = { time_stop = 1 } })
  assert(fluid:count() == 2)
end

-- What LuaJIT would make some number of, or refuse in words of C.
function tests.values_of_other_kinds_are_refused()
  local wrong, fluid = "PBF_ERROR_INVALID_ARGUMENT", filled()
  refused(wrong, "snapshots is -1", fluid.set_snapshots, fluid, -1)
  for _, steps in ipairs { -1, 1.5, 0 / 0, 2 ^ 40, "ten", {} } do refused(wrong, "steps is", fluid.step, fluid, steps) end
  refused(wrong, "steps is -1", fluid.begin_step, fluid, -1)
  refused(wrong, "first is -1", fluid.set_positions, fluid, { 0.5, 0.5, 0.5 }, -1)
  refused(wrong, "ids[1] is -1", fluid.remove, fluid, { -1 })
  refused(wrong, "desc.capacity is -1", pbf.solver, { capacity = -1 })
  refused(wrong, "desc.capacity is \"many\"", pbf.solver, { capacity = "many" })
  refused(wrong, "no desc.capacty", pbf.solver, { capacty = 1 })
  refused(wrong, "params.iterations is 1.5", fluid.set_params, fluid, { iterations = 1.5 })
  refused(wrong, "params.time_step is \"long\"", fluid.set_params, fluid, { time_step = "long" })
  refused(wrong, "params.gravity is 3", fluid.set_params, fluid, { gravity = 3 })
  refused(wrong, "params.gravity has 4", fluid.set_params, fluid, { gravity = { 0, 0, 0, 0 } })
  refused(wrong, "positions is nil", fluid.add, fluid)
  refused(wrong, "positions is", fluid.add, fluid, { "a", 0.5, 0.5 })
  refused(wrong, "no colliders[1].radus", fluid.set_colliders, fluid, { { shape = "sphere", radus = 1 } })
  refused(wrong, "colliders is 3", fluid.set_colliders, fluid, 3)
  refused(wrong, "duration is nil", fluid.move_colliders, fluid, {})
  refused(wrong, "color", fluid.map, fluid, "color", print)
  refused(wrong, "pbf_params *>: NULL; it must be a table", fluid.set_params, fluid, ffi.cast("pbf_params *", nil))
  for _, name in ipairs { "enqueue_task", "finish_task" } do
    local threads = { backend = "threads", threads = 2 }
    threads[name] = function() end
    refused(wrong, "desc." .. name .. " is a function of Lua", pbf.solver, threads)
  end
  local kept
  fluid:map("position", function(view) kept = view end)
  assert(kept.count == 0 and kept.data == nil)
  refused(wrong, "lower[2] is nil", fluid.find_in_box, fluid, { 0 }, { 1, 1, 1 })
  refused(wrong, "the state is nil", fluid.load, fluid)
  assert(fluid:count() == 2 and fluid:map("position", function(view) return view.count end) == 2)
end

function tests.closed_is_refused()
  local fluid = filled()
  fluid:close()
  fluid:close()
  refused("PBF_ERROR_INVALID_ARGUMENT", "closed", fluid.step, fluid)
end

function tests.views_end_with_their_function()
  local fluid = filled()
  local count = fluid:map(pbf.FIELD_POSITION, function(view)
    refused("PBF_ERROR_STATE", "map", fluid.step, fluid)
    return view.count
  end)
  assert(count == 2)
  local done, why = pcall(fluid.map, fluid, pbf.FIELD_POSITION, function() error("within", 0) end)
  assert(not done and why == "within")
  fluid:step()
end

function tests.snapshots_outlive_solvers()
  local fluid = filled()
  fluid:set_snapshots(2)
  local snapshot = fluid:snapshot()
  fluid:close()
  fluid = nil
  collectgarbage()
  near(ffi.cast("const float *", snapshot.positions)[3], 0.6, 1e-6)
end

function tests.colliders_move()
  local fluid = filled()
  fluid:set_colliders { { shape = "sphere", position = { 0.5, 0.2, 0.5 }, radius = 0.1 } }
  fluid:move_colliders({ { shape = "sphere", position = { 0.5, 0.3, 0.5 }, radius = 0.1 } }, 0.1)
  fluid:set_params { gravity = { 0, 0, 0 } }
  fluid:step(2)
  near(fluid:params().gravity[1], 0, 1e-12)
end

function tests.states_go_on_alike()
  local one, other = filled(), solver()
  one:step(5)
  other:load(one:save())
  one:step(5)
  other:step(5)
  assert(one:hash() == other:hash())
end

function tests.the_log_is_heard_and_its_errors_wait()
  local heard
  local fluid = solver { params = { time_step = 0.5 }, log = function(_, sentence)
    heard = sentence
    error("the log fails", 0)
  end }
  fluid:add { 0.5, 0.5, 0.5 }
  local done, why = pcall(fluid.step, fluid)
  assert(not done and why == "the log fails", why)
  assert(heard:find("time_step", 1, true), heard)
  fluid:step() -- the step was made, and the solver goes on
  assert(fluid:info().step == 2)
  refused("PBF_ERROR_INVALID_ARGUMENT", "log", fluid.begin_step, fluid)
end

-- More than LuaJIT has callbacks: those of collected solvers are given back.
function tests.collected_solvers_are_destroyed()
  local live = {}
  for _ = 1, 1100 do
    solver { capacity = 1, log = function() return live end }
    collectgarbage("step", 200)
  end
end

function tests.backends_are_told()
  local available = false
  for _, found in ipairs(pbf.backends()) do available = available or found.available end
  refused("PBF_ERROR_INVALID_ARGUMENT", "absolute", pbf.load_backend, "water.so")
  assert(available and pbf.version():match("^%d+%.%d+%.%d+$"))
end

for name, test in pairs(require("objects")(solver, near, refused)) do tests[name] = test end

local failed = 0
for name, test in pairs(tests) do
  local done, why = xpcall(test, function(thrown)
    return type(thrown) == "table" and tostring(thrown) or debug.traceback(thrown)
  end)
  print((done and "ok      " or "FAILED  ") .. name .. (done and "" or ": " .. tostring(why)))
  if not done then failed = failed + 1 end
end
-- One that is alive, and steps, when the process ends.
last = filled()
last:begin_step(1000000000)
lastWorld = pbf.batch({ worlds = 1, capacity = 1, backend = backend }):world(0)
lastWorld:begin_step(1000000000)
if failed > 0 then error(failed .. " tests failed", 0) end
