// A tap pours water over a stone; after three seconds: how much has come and gone, how high it stands, what it weighs.
/* code: pour */
using System;
using System.Globalization;
using Pbf;

internal static class Pour
{
    private static void Main()
    {
        var parameters = Params.Default;
        parameters.Loads = 1; // what the water does to solids
        var tips = new[] { .2, 0, 0, -.2, 0, 0, 0, .2, 0, 0, -.2, 0, 0, 0, .2, 0, 0, -.2 };
        using (var fluid = new Solver(new Desc { Capacity = 3000 }, parameters))
        using (var stone = Shape.FromPoints(3, tips, .025))
        {
            fluid.SetColliders(Collider.Solid(stone, new Vector3d(.5, .1, .5)));
            fluid.SetEmitters(Emitter.Disc(new Vector3d(.5, .9, .5), new Vector3d(0, -1, 0), .15));
            fluid.SetDrains(Volume.Box(new Vector3d(.95, .5, .5), new Vector3d(.05, .3, .5))); // an overflow at 0.2
            fluid.Step((uint)(2.5 / parameters.TimeStep));
            fluid.GetWallLoads(); // begins the sums anew
            fluid.Step((uint)(.5 / parameters.TimeStep));

            var inOut = fluid.GetInOut();
            double level = fluid.GetLevels(new[] { .1, 0, .1 })[0];
            var floor = fluid.GetWallLoads()[Constants.WallYMin];
            double weight = -1000 * floor.ImpulseSum.Y / floor.TimeSum; // water has 1000 kg/m³
            var density = new double[1];
            fluid.Sample(new[] { .1, .1, .1 }, densities: density);
            Console.WriteLine(string.Format(CultureInfo.InvariantCulture,
                "{0} came, {1} went, {2:0.00} m high, {3:0} N on the floor, density {4:0.0}",
                inOut.Emitted, inOut.Drained, level, weight, density[0]));
        }
    }
}
/* end */
