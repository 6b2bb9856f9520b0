// A dam break: 4,000 particles fall and spread, the front is printed ten times a second.
using System;
using System.Globalization;
using Pbf;

internal static class Splash
{
    private static void Main()
    {
        var parameters = Params.Default;
        parameters.DomainMax.X = 2; // a tank of 2 x 1 x 1, particles 0.05 apart
        using (var fluid = new Solver(new Desc { Capacity = 4000 }, parameters))
        {
            var positions = new float[3 * 4000];
            for (int i = 0; i < 4000; ++i)
            {
                positions[3 * i] = 0.025f + 0.05f * (i % 10);
                positions[3 * i + 1] = 0.025f + 0.05f * (i / 10 % 20);
                positions[3 * i + 2] = 0.025f + 0.05f * (i / 200);
            }
            fluid.AddParticles(positions);
            for (int frame = 1; frame <= 10; ++frame)
            {
                fluid.Step((uint)Math.Round(0.1 / parameters.TimeStep));
                Console.WriteLine(string.Format(CultureInfo.InvariantCulture, "{0:0.0} s: front at {1:0.00} m",
                    0.1 * frame, fluid.GetStats().PositionMax.X));
            }
        }
    }
}
