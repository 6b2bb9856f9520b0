-- Shapes, queries, emitters, phases, loads and batches, against what geometry and mechanics say they must be: tests for
-- binding.lua, by what they have in common.
local ffi = require("ffi")
local pbf = require("pbf")

local D = 0.05 -- the spacing by default
local wrong = "PBF_ERROR_INVALID_ARGUMENT"

return function(solver, near, refused)
  local tests = {}

  -- A lattice of 10 by 10 by 10 particles, at rest, in a corner of the tank.
  local function block()
    local fluid, positions = solver { capacity = 1000 }, {}
    for i = 0, 999 do
      positions[#positions + 1] = { D * (i % 10 + 0.5), D * (math.floor(i / 10) % 10 + 0.5), D * (math.floor(i / 100) + 0.5) }
    end
    fluid:add(positions)
    return fluid
  end

  -- Half extents 0.2, 0.1 and 0.3, by its corners.
  local function brick()
    local corners = {}
    for x = -1, 1, 2 do
      for y = -1, 1, 2 do
        for z = -1, 1, 2 do corners[#corners + 1] = { 0.2 * x, 0.1 * y, 0.3 * z } end
      end
    end
    return pbf.shape_from_points { dimension = 3, points = corners, cell = 0.025 }
  end

  function tests.shapes_are_as_far_as_their_faces()
    local shape = brick()
    near(shape:info().volume, 0.2 * 0.1 * 0.3 * 8, 1e-3)
    local distance, normal = shape:distance { 0.24, 0, 0 }
    near(distance, 0.04, 1e-3)
    near(normal[0], 1, 1e-3)
    near(shape:distance { 0, 0.06, 0 }, -0.04, 1e-3)
    local square = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } }
    local mesh = pbf.shape_from_mesh { dimension = 2, vertices = square, faces = { 0, 1, 1, 2, 2, 3, 3, 0 }, cell = 0.05 }
    near(mesh:info().volume, 1, 5e-3)
    near(mesh:distance { 1.08, 0.5 }, 0.08, 1e-3)
    local shell = pbf.shape_from_mesh { dimension = 2, vertices = { 0, 0, 1, 0 }, faces = { 0, 1 }, cell = 0.05, thickness = 0.2 }
    near(shell:distance { 0.5, 0.18 }, 0.08, 1e-3)
    local hill = pbf.shape_from_heights { count = { 3 }, heights = { 0.5, 0.5, 0.5 }, spacing = 0.5, base = -0.5, cell = 0.05 }
    near(hill:distance { 0.5, 0.58 }, 0.08, 1e-3)
    local values = ffi.new("float[441]") -- a disc of radius 0.3
    for i = 0, 440 do values[i] = 0.05 * math.sqrt((i % 21 - 10) ^ 2 + (math.floor(i / 21) - 10) ^ 2) - 0.3 end
    local grid = { nodes = { 21, 21 }, origin = { -0.5, -0.5 }, cell = 0.05, values = values, count_of = { values = 441 } }
    near(pbf.shape_from_grid(grid):distance { 0.4, 0 }, 0.1, 2e-3)
    grid.count_of.values = 442
    refused(wrong, "grid.values has 441 numbers", pbf.shape_from_grid, grid)
  end

  function tests.shapes_come_back_from_bytes()
    local shape = brick()
    local again, info = pbf.load_shape(shape:save()), shape:info()
    assert(again:info().hash == info.hash and again.dimension == 3)
    local values, count = again:values()
    assert(count == info.nodes[0] * info.nodes[1] * info.nodes[2])
    near(values[0], math.sqrt((info.origin[0] + 0.2) ^ 2 + (info.origin[1] + 0.1) ^ 2 + (info.origin[2] + 0.3) ^ 2), 1e-3)
    refused("PBF_ERROR_DATA", "cut short", pbf.load_shape, "PBFSHAPE")
    refused(wrong, "a string that save has given", pbf.load_shape, 7)
  end

  function tests.shapes_live_while_something_has_them()
    local fluid, shape = block(), brick()
    fluid:set_colliders { { shape = shape, position = { 0.7, 0.9, 0.7 } }, { shape = "plane", axis = { 0, 1, 0 } } }
    assert(shape:info().references == 2)
    shape:close()
    shape:close()
    refused(wrong, "closed", shape.info, shape)
    refused(wrong, "colliders[1].shape is closed", fluid.set_colliders, fluid, { { shape = shape } })
    fluid:step()
    local back = fluid:colliders()
    near(back[1].position[2], 0.9, 1e-12)
    assert(back[2].shape == "plane")
    fluid:set_colliders(back)
    fluid:close()
    assert(back[1].shape:info().references == 1)
    for _ = 1, 50 do -- what nothing has any more is collected, and not before
      local other = solver { capacity = 1 }
      other:set_colliders { { shape = brick(), position = { 0.5, 0.5, 0.5 } } }
      collectgarbage()
      other:step()
    end
  end

  function tests.what_is_no_shape_is_refused()
    local from_points, from_mesh = pbf.shape_from_points, pbf.shape_from_mesh
    refused(wrong, "point_count is 3", from_points, { dimension = 3, points = { 0, 0, 0, 1, 0, 0, 0, 1, 0 }, cell = 0.1 })
    refused(wrong, "hull.points has 8 numbers", from_points, { dimension = 3, points = { 1, 2, 3, 4, 5, 6, 7, 8 }, cell = 0.1 })
    refused(wrong, "hull.dimension is 4", from_points, { dimension = 4, points = {}, cell = 0.1 })
    refused(wrong, "no hull.points", from_points, { dimension = 3, cell = 0.1 })
    refused(wrong, "no hull.sell", from_points, { dimension = 3, points = {}, sell = 0.1 })
    refused(wrong, "grid.values has 8 numbers, of 9", pbf.shape_from_grid,
      { nodes = { 3, 3 }, origin = { 0, 0 }, cell = 0.1, values = { 1, 1, 1, 1, 1, 1, 1, 1 } })
    refused(wrong, "heights.heights has 3", pbf.shape_from_heights,
      { count = { 2, 2 }, heights = { 1, 1, 1 }, spacing = 1, base = -1, cell = 0.1 })
    refused(wrong, "faces[1][1] is 7", from_mesh, { dimension = 2, vertices = { 0, 0, 1, 0, 1, 1 }, faces = { 0, 1, 1, 7 }, cell = 0.1 })
    refused(wrong, "mesh.faces[2] is -1", from_mesh, { dimension = 2, vertices = { 0, 0, 1, 0 }, faces = { 0, -1 }, cell = 0.1 })
    refused(wrong, "point", brick().distance, brick(), { 1, 2 })
    local flat = solver { dimension = 2 }
    refused(wrong, "3D", flat.set_colliders, flat, { { shape = brick() } })
  end

  function tests.queries_know_water_at_rest()
    local fluid = block()
    local at, count = fluid:sample({ { 0.25, 0.25, 0.25 }, { 0.9, 0.9, 0.9 } }, { "densities", "velocities", "pressures", "wet" })
    assert(count == 2)
    near(at.densities[0], 1, 0.01)
    assert(at.densities[1] == 0 and at.velocities[5] == 0 and at.wet[0] == 1 and at.wet[1] == 0)
    local along, points = fluid:sample_on_grid({ counts = { 1, 1, 3 }, origin = { 0.25, 0.25, 0.25 }, step = { 0, 0, 0.3 } }, { "densities" })
    assert(points == 3 and along.velocities == nil)
    near(along.densities[0], 1, 0.01)
    assert(along.densities[1] < 0.5 and along.densities[2] == 0) -- above the surface
    local levels = fluid:levels { { 0.25, 0, 0.25 }, { 0.9, 0, 0.9 } }
    near(levels[0], 0.5, 0.01)
    assert(levels[1] ~= levels[1])
    local distances, normals, rays = fluid:cast_rays({ { 0.25, 0.9, 0.25 }, { 0.9, 0.9, 0.9 } }, { { 0, -1, 0 }, { 0, -1, 0 } })
    assert(rays == 2 and distances[1] == math.huge)
    near(distances[0], 0.4, 0.01)
    near(normals[1], 1, 0.01)
    local ids, found = fluid:find_in { shape = "box", position = { 0.05, 0.05, 0.05 }, half_extents = { 0.05, 0.05, 0.05 } }
    assert(found == 8 and ids[7] == 111)
    local flows, volumes = fluid:measure {
      { shape = "box", position = { 0.25, 0.5, 0.25 }, half_extents = { 0.1, 0.1, 0.1 } },
      { shape = "sphere", position = { 0.8, 0.8, 0.8 }, radius = 0.1 },
      { shape = "capsule", position = { 0.25, 0.25, 0.25 }, axis = { 1, 0, 0 }, half_length = 0.1, radius = 0.05 },
    }
    assert(volumes == 3 and flows[1].fraction == 0)
    near(flows[0].volume, 0.008, 1e-12)
    near(flows[0].fraction, 0.5, 0.05)
    near(flows[2].fraction, 1, 1e-9)
    fluid:end_queries()
  end

  function tests.queries_want_arrays_that_fit()
    local fluid = block()
    refused(wrong, "points has 4 numbers", fluid.sample, fluid, { 1, 2, 3, 4 })
    refused(wrong, "no field colours", fluid.sample, fluid, { 1, 2, 3 }, { "colours" })
    refused(wrong, "points holds float; it must hold double", fluid.sample, fluid, ffi.new("float[3]"), nil, 1)
    refused(wrong, "points has 3 numbers, and 6 are wanted", fluid.sample, fluid, ffi.new("double[3]"), nil, 2)
    refused(wrong, "the number of points", fluid.sample_on_grid, fluid, { counts = { 2 ^ 31, 2 ^ 31, 4 } })
    refused(wrong, "directions has 0 rows, origins 1", fluid.cast_rays, fluid, { 1, 2, 3 }, {})
    refused(wrong, "volumes[1].shape is cone; known are: box, sphere, capsule", fluid.measure, fluid, { { shape = "cone" } })
    refused(wrong, "positions has 30 numbers, and 33 are wanted", fluid.set_positions, fluid, ffi.new("float[30]"), 0, 11)
    local function give(values) fluid:set_velocities(values, 0, 2) end
    for _, other in ipairs { 8LL, require("pbf").params(), ffi.new("float *[6]"), ffi.typeof("float[6]"), ffi.new("struct { float x[6]; }") } do
      refused(wrong, "it must be an array of float, or a pointer", give, other)
    end
    refused(wrong, "velocities holds double; it must hold float", give, ffi.new("double[6]") + 0)
    local six, rows, member = ffi.new("float[6]", 1), ffi.new("float[2][3]"), ffi.new("struct { float x[6]; }")
    for _, fine in ipairs { six, six + 0, ffi.cast("const float *", six), ffi.cast("void *", six), rows, rows + 0, member.x } do give(fine) end
  end

  function tests.as_much_comes_as_the_rate_says()
    local fluid = solver { capacity = 1000, params = { time_step = 1 / 128, gravity = { 0, 0, 0 } } }
    local tap = { shape = "disc", position = { 0.5, 0.9, 0.5 }, velocity = { 0, -1, 0 }, radius = 0.15, rate = 0.0371 }
    fluid:set_emitters { tap }
    fluid:set_drains { { shape = "box", position = { 0.5, 0.1, 0.5 }, half_extents = { 0.5, 0.1, 0.5 } } }
    fluid:step(256)
    local after = fluid:in_out()
    near(tonumber(after.emitted), 0.0371 * 2 / D ^ 3, 1)
    assert(after.drained > 0 and after.emitted - after.drained == fluid:count())
    fluid:set_emitters(fluid:emitters())
    fluid:set_drains(fluid:drains())
    near(fluid:emitters()[1].radius, 0.15, 0)
    near(fluid:drains()[1].half_extents[2], 0.1, 0)
    fluid:set_reservoirs { { position = { 0.5, 0.5, 0.5 }, half_extents = { 0.5, 0.5, 0.5 }, depth = 0.1 } }
    fluid:step(1)
    assert(fluid:reservoirs()[1].added > 0 and fluid:reservoirs()[1].depth == 0.1)
    fluid:set_reservoirs(fluid:reservoirs())
    fluid:set_reservoirs {}
    assert(#fluid:reservoirs() == 0)
    tap.rate = 100
    refused(wrong, "emitters[0].rate is 100", fluid.set_emitters, fluid, { tap })
    refused(wrong, "emitters[1].shape is cone; known are: rectangle, disc", fluid.set_emitters, fluid, { { shape = "cone" } })
  end

  -- Oil that begins below water: it rises, and the floor has the weight of both, beside what the full tank's ceiling pushes back.
  function tests.oil_floats_and_the_floor_bears_both()
    local fluid = solver { dimension = 2, precision = pbf.FLOAT64, capacity = 200, params = { domain_max = { 0.5, 1, 1 }, loads = 1 } }
    local positions, oil = {}, {}
    for i = 0, 199 do positions[i + 1] = { D * (i % 10 + 0.5), D * (math.floor(i / 10) + 0.5) } end
    for i = 1, 100 do oil[i] = 1 end
    fluid:add(positions)
    fluid:set_phases { {}, { rest_density = 0.5 } }
    fluid:set_particle_phases(oil)
    near(fluid:phases()[2].rest_density, 0.5, 0)
    local params = fluid:params()
    fluid:step(math.floor(10 / params.time_step))
    fluid:wall_loads()
    fluid:step(math.floor(1 / params.time_step))
    local x, phases, sums = fluid:positions(), fluid:particle_phases(), { [0] = 0, 0 }
    for i = 0, 199 do sums[phases[i]] = sums[phases[i]] + x[2 * i + 1] / 100 end
    assert(sums[1] > sums[0] + 0.3, sums[1] .. " and " .. sums[0])
    local loads = fluid:wall_loads()
    local impulse = loads[pbf.WALL_Y_MIN].impulse_sum[1] + loads[pbf.WALL_Y_MAX].impulse_sum[1]
    near(impulse / loads[0].time_sum / (D * D * (100 + 0.5 * 100) * params.gravity[1]), 1, 0.005)
    refused(wrong, "phases[0] is 2", fluid.set_particle_phases, fluid, { 2 })
    refused(wrong, "phases[0].rest_density is -1", fluid.set_phases, fluid, { { rest_density = -1 }, {} })
  end

  function tests.fields_are_read_as_renderers_want_them()
    local fluid = solver { precision = pbf.FLOAT64, params = { gravity = { 0, 0, 0 } } }
    fluid:add({ { 0.25, 0.5, 0.5 }, { 0.75, 0.5, 0.5 } }, { { 3, 0, -4 }, { 0, 0, 0 } })
    fluid:keep_previous(true)
    fluid:step()
    local rows, count = fluid:read("position", { components = 4, w = pbf.W_SPEED, element = "float" })
    assert(count == 2 and ffi.sizeof(rows) == 8 * 4)
    near(rows[0], 0.25 + 3 * fluid:params().time_step, 1e-6)
    assert(rows[3] == 5 and rows[4] == 0.75 and rows[7] == 0)
    local before = fluid:read("position", { behind = 1, first = 1 })
    assert(before[0] == 0.75 and fluid:read("id")[1] == 1)
    refused(wrong, "colour", fluid.read, fluid, "colour")
    refused(wrong, "components is 9", fluid.read, fluid, "position", { components = 9 })
    refused(wrong, "no option stride", fluid.read, fluid, "position", { stride = 8 })
    refused(wrong, "", fluid.read, fluid, "position", { count = 3 })
  end

  -- Inside a fluid at rest particles are balls; alone they are half as large.
  function tests.anisotropies_are_of_the_neighbours()
    local fluid = block()
    local x, stretches, count = fluid:anisotropies { first = 555, count = 1 }
    assert(count == 1)
    near(x[0], 0.275, 1e-6)
    for k = 0, 8 do near(stretches[k], k % 4 == 0 and 1 or 0, 0.02) end
    fluid:set_positions { 0.9, 0.9, 0.9 }
    near(select(2, fluid:anisotropies())[4], 0.5, 1e-6)
    refused(wrong, "no options.radios", fluid.anisotropies, fluid, { radios = 1 })
  end

  local function batch(options)
    options.backend, options.threads, options.capacity = os.getenv("PBF_TEST_BACKEND") or "auto", 2, options.capacity or 10
    return pbf.batch(options)
  end

  function tests.worlds_fall_as_they_would_alone()
    local worlds = batch { worlds = 3, precision = pbf.FLOAT64 }
    local alone = solver { precision = pbf.FLOAT64, capacity = 10 }
    assert(worlds:info().worlds == 3)
    worlds:add({ 1, 0, 2 }, { 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5 })
    assert(worlds:counts()[2] == 2)
    worlds:set_start()
    worlds:set_gravity { { 0, -1, 0 }, { 0, -2, 0 }, { 3, 0, 0 } }
    worlds:step(12, { true, false, true })
    local v, rows = worlds:read("velocity")
    local t = 12 * alone:params().time_step
    assert(rows == 2)
    near(v[1], -t, 1e-12)
    for i = 3, 11 do assert(v[i] == 0) end -- rows that worlds have not
    near(v[12], 3 * t, 1e-9)

    alone:add { 0.5, 0.5, 0.5 }
    alone:set_params { gravity = { 0, -1, 0 } }
    alone:step(12)
    assert(alone:hash() == worlds:world(0):hash())
    worlds:reset { true, false, false }
    near(worlds:world(0):positions()[1], 0.5, 0)
    near(worlds:world(0):params().gravity[1], -9.81, 1e-12)
    worlds:set_colliders { { shape = "sphere", position = { 0.2, 0.2, 0.2 }, radius = 0.1 } }
    worlds:move_colliders({ { 0.2, 0.3, 0.2 }, { 0.2, 0.3, 0.2 }, { 0.2, 0.3, 0.2 } }, 0.1)
    worlds:step(12)
    near(worlds:world(1):colliders()[1].position[2], 0.3, 1e-9)
  end

  function tests.a_world_that_fails_says_so()
    local worlds = batch { worlds = 2 }
    worlds:add({ 0, 1 }, { 0.5, 0.5, 0.5 })
    worlds:world(1):map("position", function()
      refused("PBF_ERROR_STATE", "world 1: ", worlds.step, worlds)
      local failures = worlds:failures()
      assert(failures[0] == nil and failures[1].name == "PBF_ERROR_STATE" and tostring(failures[1]):find("map"))
    end)
    refused(wrong, "mask has 1", worlds.step, worlds, 1, { true })
    refused(wrong, "there are 1 positions", worlds.add, worlds, { 1, 1 }, { 0.5, 0.5, 0.5 })
    refused(wrong, "gravity has 1", worlds.set_gravity, worlds, { 0, 0, 0 })
    refused(wrong, "colour", worlds.read, worlds, "colour")
    refused("PBF_ERROR_NOT_FOUND", "world is 2", worlds.world, worlds, 2)
    refused(wrong, "worlds is nil", batch, {})
    refused(wrong, "log", batch, { worlds = 1, log = print })
  end

  -- Without drag it falls along a parabola.
  function tests.spray_flies()
    local fluid = block()
    local x, v = { { 0.7, 0.9, 0.7 }, { 0.8, 0.9, 0.7 } }, { { 0.5, 0, 0 }, { 0, 0.25, 0 } }
    refused("PBF_ERROR_STATE", "pbf_set_diffuse", fluid.add_diffuse, fluid, x, v, { 1, 2 })
    assert(fluid:diffuse() == nil)
    fluid:set_diffuse { capacity = 7 }
    assert(fluid:diffuse().capacity == 7 and fluid:diffuse().energy_max == fluid:default_diffuse().energy_max)
    fluid:add_diffuse(x, v, { 1, 2 })
    fluid:add_diffuse({ 0.8, 0.8, 0.8 }, nil, { 0.01 })
    fluid:shift_diffuse { 0, -0.25, 0 }
    fluid:step(8)
    local info = fluid:diffuse_info()
    assert(info.count == 2 and info.spray == 2 and info.expired == 1)
    local drops, count = fluid:diffuse_particles()
    local params = fluid:params()
    local time, fall = 8 * params.time_step, params.gravity[1] / 2 * (8 * params.time_step) ^ 2
    assert(count == 2 and drops.kinds[1] == pbf.DIFFUSE_SPRAY and drops.ids[1] == 1)
    near(drops.positions[0], 0.7 + 0.5 * time, 1e-6)
    near(drops.positions[1], 0.65 + fall, 1e-6)
    near(drops.positions[4], 0.65 + 0.25 * time + fall, 1e-6)
    near(drops.velocities[4], 0.25 + params.gravity[1] * time, 1e-6)
    near(drops.lives[1], 2 - time, 1e-6)
    near(drops.ages[1], time, 1e-6)
    refused(wrong, "lives has 1 numbers, positions 2 rows", fluid.add_diffuse, fluid, x, v, { 1 })
    refused(wrong, "velocities has 1 rows", fluid.add_diffuse, fluid, x, { 0, 0, 0 }, { 1, 2 })
    refused(wrong, "lives[1]", fluid.add_diffuse, fluid, x, nil, { 1, 0 })
    refused(wrong, "way has 2 numbers", fluid.shift_diffuse, fluid, { 0, 0 })
    refused(wrong, "capacity is 0", fluid.set_diffuse, fluid, { capacity = 0 })
    refused(wrong, "there is no diffuse.foam", fluid.set_diffuse, fluid, { foam = 3 })
    assert(fluid:diffuse_info().count == 2)
    fluid:set_diffuse()
    assert(fluid:diffuse_info().capacity == 0 and select(2, fluid:diffuse_particles()) == 0)
  end

  function tests.worlds_and_batches_go_in_any_order()
    local worlds = batch { worlds = 2 }
    worlds:add({ 1, 1 }, { 0.5, 0.5, 0.5, 0.5, 0.5, 0.5 })
    local world = worlds:world(0)
    world:begin_step(1000000000)
    world:close() -- and with it these steps
    worlds:step()
    local kept = worlds:world(1)
    worlds = nil
    collectgarbage()
    kept:step() -- the batch lives on for it
    assert(kept:info().step == 2)
    kept.batch:close()
    refused(wrong, "closed", kept.step, kept)
  end

  return tests
end
