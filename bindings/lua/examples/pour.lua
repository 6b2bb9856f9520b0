-- A tap pours water over a stone; after three seconds: how much has come and gone, how high it stands, what it weighs.
--[[ code: pour ]]
local pbf = require("pbf")
local fluid = pbf.solver { capacity = 3000, params = { loads = 1 } } -- loads: what the water does to solids

local tips = { { 0.2, 0, 0 }, { -0.2, 0, 0 }, { 0, 0.2, 0 }, { 0, -0.2, 0 }, { 0, 0, 0.2 }, { 0, 0, -0.2 } }
local stone = pbf.shape_from_points { dimension = 3, points = tips, cell = 0.025 }
fluid:set_colliders { { shape = stone, position = { 0.5, 0.1, 0.5 } } }
fluid:set_emitters { { shape = "disc", position = { 0.5, 0.9, 0.5 }, velocity = { 0, -1, 0 }, radius = 0.15 } }
fluid:set_drains { { shape = "box", position = { 0.95, 0.5, 0.5 }, half_extents = { 0.05, 0.3, 0.5 } } } -- an overflow at 0.2
local time_step = fluid:params().time_step
fluid:step(math.floor(2.5 / time_step))
fluid:wall_loads() -- begins the sums anew
fluid:step(math.floor(0.5 / time_step))

local in_out = fluid:in_out()
local level = fluid:levels({ 0.1, 0, 0.1 })[0] -- arrays of C begin at 0
local floor = fluid:wall_loads()[pbf.WALL_Y_MIN]
local weight = -1000 * floor.impulse_sum[1] / floor.time_sum -- water has 1000 kg/m³
local density = fluid:sample({ 0.1, 0.1, 0.1 }, { "densities" }).densities[0]
print(string.format("%d came, %d went, %.2f m high, %.0f N on the floor, density %.1f",
  tonumber(in_out.emitted), tonumber(in_out.drained), level, weight, density))
--[[ end ]]
