-- A dam break: 4,000 particles fall and spread, the front is printed ten times a second.
local pbf = require("pbf")

local fluid = pbf.solver {
  capacity = 4000,
  params = { domain_max = { 2, 1, 1 } }, -- particles 0.05 apart
}
local positions = {}
for z = 0, 19 do
  for y = 0, 19 do
    for x = 0, 9 do
      positions[#positions + 1] = { 0.025 + 0.05 * x, 0.025 + 0.05 * y, 0.025 + 0.05 * z }
    end
  end
end
fluid:add(positions)

local steps = math.floor(0.1 / fluid:params().time_step + 0.5)
for frame = 1, 10 do
  fluid:step(steps)
  print(string.format("%.1f s: front at %.2f m", 0.1 * frame, fluid:stats().position_max[0]))
end
