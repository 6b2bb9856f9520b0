// Shapes, queries, emitters, phases, loads and batches, against what geometry and mechanics say they must be.
using System;
using System.Collections.Generic;
using System.Linq;
using System.Runtime.CompilerServices;
using Pbf;

internal static partial class Binding
{
    private const double D = 0.05; // the spacing by default

    private static Desc DescOf(uint dimension, uint capacity, uint precision = Constants.Float32)
    {
        var desc = TestDesc();
        desc.Dimension = dimension;
        desc.Capacity = capacity;
        desc.Precision = precision;
        return desc;
    }

    private static Vector3d At(double x, double y, double z) { return new Vector3d(x, y, z); }

    // A lattice of 10 by 10 by 10 particles, at rest, in a corner of the tank.
    private static Solver Block()
    {
        var fluid = new Solver(DescOf(3, 1000));
        var positions = new float[3000];
        for (int i = 0; i < 1000; ++i)
        {
            positions[3 * i] = (float)(D * (i % 10 + .5));
            positions[3 * i + 1] = (float)(D * (i / 10 % 10 + .5));
            positions[3 * i + 2] = (float)(D * (i / 100 + .5));
        }
        fluid.AddParticles(positions);
        return fluid;
    }

    // Half extents 0.2, 0.1 and 0.3, by its corners.
    private static Shape Brick()
    {
        var corners = new List<double>();
        for (int i = 0; i < 8; ++i)
            corners.AddRange(new[] { .2 * (2 * (i & 1) - 1), .1 * ((i & 2) - 1), .3 * ((i & 4) / 2 - 1) });
        return Shape.FromPoints(3, corners.ToArray(), .025);
    }

    private static void ShapesAreAsFarAsTheirFaces()
    {
        using (var brick = Brick())
        {
            Near(.2 * .1 * .3 * 8, brick.GetInfo().Volume, 1e-3);
            Near(.04, brick.GetDistance(At(.24, 0, 0), out Vector3d normal), 1e-3);
            Near(1, normal.X, 1e-3);
            Near(-.04, brick.GetDistance(At(0, .06, 0)), 1e-3);
        }
        var square = new double[] { 0, 0, 1, 0, 1, 1, 0, 1 };
        using (var mesh = Shape.FromMesh(2, square, new uint[] { 0, 1, 1, 2, 2, 3, 3, 0 }, .05))
        {
            Near(1, mesh.GetInfo().Volume, 5e-3);
            Near(.08, mesh.GetDistance(At(1.08, .5, 0)), 1e-3);
        }
        using (var shell = Shape.FromMesh(2, new double[] { 0, 0, 1, 0 }, new uint[] { 0, 1 }, .05, .2))
            Near(.08, shell.GetDistance(At(.5, .18, 0)), 1e-3);
        using (var hill = Shape.FromHeights(new uint[] { 3 }, new[] { .5, .5, .5 }, .5, -.5, .05))
            Near(.08, hill.GetDistance(At(.5, .58, 0)), 1e-3);
        var values = new float[21 * 21]; // a disc of radius 0.3
        for (int i = 0; i < values.Length; ++i)
            values[i] = (float)(Math.Sqrt(Math.Pow(.05 * (i % 21 - 10), 2) + Math.Pow(.05 * (i / 21 - 10), 2)) - .3);
        using (var disc = Shape.FromGrid(new uint[] { 21, 21 }, new[] { -.5, -.5 }, .05, values))
        {
            Near(.1, disc.GetDistance(At(.4, 0, 0)), 2e-3);
            Equal(21u, disc.GetInfo().Nodes.Y);
        }
    }

    private static void ShapesComeBackFromBytes()
    {
        using (var brick = Brick())
        using (var again = Shape.Load(brick.Save()))
        {
            var info = brick.GetInfo();
            Equal(info.Hash, again.GetInfo().Hash);
            var values = again.GetValues();
            Equal((long)info.Nodes.X * info.Nodes.Y * info.Nodes.Z, values.LongLength);
            var o = info.Origin;
            Near(Math.Sqrt(Math.Pow(o.X + .2, 2) + Math.Pow(o.Y + .1, 2) + Math.Pow(o.Z + .3, 2)), values[0], 1e-3);
            Refused(Status.Data, "does not begin as one", () => Shape.Load(new byte[100]));
        }
    }

    private static void ShapesLiveWhileSomethingHasThem()
    {
        var fluid = Block();
        var shape = Brick();
        fluid.SetColliders(Collider.Solid(shape, At(.7, .9, .7)));
        Equal(2u, shape.GetInfo().References);
        shape.Dispose();
        Thrown<ObjectDisposedException>(() => shape.GetInfo());
        Thrown<ObjectDisposedException>(() => fluid.SetColliders(Collider.Solid(shape, At(0, 0, 0))));
        fluid.Step();
        shape = fluid.GetColliders()[0].Geometry;
        fluid.Dispose();
        Equal(1u, shape.GetInfo().References);
        shape.Dispose();
        shape.Dispose();
    }

    // A collider holds its shape, though nothing else has it any more.
    private static void CollidersHoldTheirShapes()
    {
        using (var fluid = Block())
        {
            var colliders = Solids();
            GC.Collect();
            GC.WaitForPendingFinalizers();
            fluid.SetColliders(colliders);
            fluid.Step();
        }
    }

    [MethodImpl(MethodImplOptions.NoInlining)]
    private static Collider[] Solids()
    {
        return Enumerable.Range(0, 50).Select(i => Collider.Solid(Brick(), At(.7, .9, .7))).ToArray();
    }

    private static void WhatIsNoShapeIsRefused()
    {
        const Status wrong = Status.InvalidArgument;
        Refused(wrong, "point_count is 3", () => Shape.FromPoints(3, new double[9], .1));
        Refused(wrong, "8 numbers", () => Shape.FromPoints(3, new double[8], .1));
        Refused(wrong, "4 dimensions", () => Shape.FromPoints(4, new double[8], .1));
        Refused(wrong, "points is null", () => Shape.FromPoints(3, null, .1));
        Refused(wrong, "values has 8", () => Shape.FromGrid(new uint[] { 3, 3 }, new double[2], .1, new float[8]));
        Refused(wrong, "values has 9", () => Shape.FromGrid(new[] { 3u, uint.MaxValue, uint.MaxValue }, new double[3], .1, new float[9]));
        Refused(wrong, "origin has 3", () => Shape.FromGrid(new uint[] { 3, 3 }, new double[3], .1, new float[9]));
        Refused(wrong, "heights has 3", () => Shape.FromHeights(new uint[] { 2, 2 }, new double[3], 1, -1, .1));
        Refused(wrong, "faces[1][1] is 7",
            () => Shape.FromMesh(2, new double[] { 0, 0, 1, 0, 1, 1 }, new uint[] { 0, 1, 1, 7 }, .1));
        using (var fluid = new Solver(DescOf(2, 1)))
            Refused(wrong, "3D", () => fluid.SetColliders(Collider.Solid(Brick(), At(.5, .5, 0))));
    }

    private static void QueriesKnowWaterAtRest()
    {
        using (var fluid = Block())
        {
            double[] rho = new double[2], v = new double[6], p = new double[2], along = new double[3];
            var wet = new byte[2];
            fluid.Sample(new[] { .25, .25, .25, .9, .9, .9 }, rho, v, p, wet);
            Near(1, rho[0], .01);
            Near(0, rho[1], 0);
            Equal("1 0", $"{wet[0]} {wet[1]}");
            fluid.SampleOnGrid(new Vector3u(1, 1, 3), At(.25, .25, .25), At(0, 0, .3), densities: along);
            Near(1, along[0], .01);
            Equal(true, along[1] < .5 && along[2] == 0); // above the surface
            Near(.5, fluid.GetLevels(new[] { .25, 0, .25 })[0], .01);
            Equal(true, double.IsNaN(fluid.GetLevels(new[] { .9, 0, .9 })[0]));
            double[] distances = new double[2], normals = new double[6];
            fluid.CastRays(new[] { .25, .9, .25, .9, .9, .9 }, new double[] { 0, -1, 0, 0, -1, 0 }, double.PositiveInfinity, distances, normals);
            Near(.4, distances[0], .01);
            Near(1, normals[1], .01);
            Equal(true, double.IsInfinity(distances[1]));
            Equal("0 1 10 11 100 101 110 111", string.Join(" ", fluid.FindIn(Volume.Box(At(.05, .05, .05), At(.05, .05, .05)))));
            var flows = fluid.Measure(Volume.Box(At(.25, .5, .25), At(.1, .1, .1)), Volume.Sphere(At(.8, .8, .8), .1),
                Volume.Capsule(At(.25, .25, .25), At(1, 0, 0), .1, .05));
            Near(.008, flows[0].Volume, 1e-12);
            Near(.5, flows[0].Fraction, .05);
            Near(0, flows[1].Fraction, 0);
            Near(1, flows[2].Fraction, 1e-9);
        }
    }

    private static void QueriesWantArraysThatFit()
    {
        const Status wrong = Status.InvalidArgument;
        using (var fluid = Block())
        {
            Refused(wrong, "densities has 1 elements; it must have 2", () => fluid.Sample(new double[6], new double[1]));
            Refused(wrong, "velocities has 3", () => fluid.Sample(new double[6], velocities: new double[3]));
            Refused(wrong, "points has 4", () => fluid.Sample(new double[4]));
            Refused(wrong, "wet has 1", () => fluid.SampleOnGrid(new Vector3u(1, 1, 2), At(0, 0, 0), At(1, 1, 1), wet: new byte[1]));
            Refused(wrong, "counts", () => fluid.SampleOnGrid(new Vector3u(1u << 31, 1u << 31, 4), At(0, 0, 0), At(1, 1, 1)));
            Refused(wrong, "directions has 2", () => fluid.CastRays(new double[3], new double[2], 1, new double[1]));
            Refused(wrong, "normals has 1", () => fluid.CastRays(new double[3], new double[3], 1, new double[1], new double[1]));
            Refused(wrong, "points has 4", () => fluid.GetLevels(new double[4]));
            Refused(wrong, "volumes is null", () => fluid.Measure(null));
            fluid.EndQueries();
        }
    }

    private static void AsMuchComesAsTheRateSays()
    {
        var parameters = Params.Default;
        parameters.TimeStep = 1.0 / 128;
        parameters.Gravity = At(0, 0, 0);
        using (var fluid = new Solver(DescOf(3, 1000), parameters))
        {
            var tap = Emitter.Disc(At(.5, .9, .5), At(0, -1, 0), .15);
            tap.Rate = .0371;
            fluid.SetEmitters(tap);
            fluid.SetDrains(Volume.Box(At(.5, .1, .5), At(.5, .1, .5)));
            fluid.Step(256);
            var after = fluid.GetInOut();
            Near(.0371 * 2 / (D * D * D), after.Emitted, 1);
            Equal(true, after.Drained > 0);
            Equal((ulong)fluid.Count, after.Emitted - after.Drained);
            fluid.SetEmitters(tap, Emitter.Rectangle(At(.5, .7, .5), At(0, -1, 0), .1, .125));
            Near(.125, fluid.GetEmitters()[1].HalfHeight, 0);
            Near(.1, fluid.GetDrains()[0].HalfExtents.Y, 0);
            fluid.SetReservoirs(Reservoir.Box(At(.5, .5, .5), At(.5, .5, .5), .1));
            fluid.Step(1);
            Equal(true, fluid.GetReservoirs()[0].Added > 0);
            fluid.SetReservoirs();
            Equal(0, fluid.GetReservoirs().Length);
            tap.Rate = 100;
            Refused(Status.InvalidArgument, "emitters[0].rate is 100", () => fluid.SetEmitters(tap));
            Refused(Status.InvalidArgument, "drains is null", () => fluid.SetDrains(null));
        }
    }

    // Oil that begins below water: it rises, and the floor has the weight of both, beside what the full tank's ceiling pushes back.
    private static void OilFloatsAndTheFloorBearsBoth()
    {
        var parameters = Params.Default;
        parameters.DomainMax = At(.5, 1, 1);
        parameters.Loads = 1;
        using (var fluid = new Solver(DescOf(2, 200, Constants.Float64), parameters))
        {
            var x = new double[400];
            for (int i = 0; i < 200; ++i)
            {
                x[2 * i] = D * (i % 10 + .5);
                x[2 * i + 1] = D * (i / 10 + .5);
            }
            fluid.AddParticles(x);
            fluid.SetPhases(Phase.Of(1), Phase.Of(.5));
            fluid.SetParticlePhases(Enumerable.Repeat(1u, 100).ToArray());
            Near(.5, fluid.GetPhases()[1].RestDensity, 0);
            fluid.Step((uint)(10 / parameters.TimeStep));
            fluid.GetWallLoads();
            fluid.Step((uint)(1 / parameters.TimeStep));
            fluid.GetPositions(x);
            var phases = fluid.GetParticlePhases();
            Func<uint, double> mean = phase => Enumerable.Range(0, 200).Where(i => phases[i] == phase).Average(i => x[2 * i + 1]);
            Equal(true, mean(1) > mean(0) + .3);
            var loads = fluid.GetWallLoads();
            double impulse = loads[Constants.WallYMin].ImpulseSum.Y + loads[Constants.WallYMax].ImpulseSum.Y;
            Near(1, impulse / loads[0].TimeSum / (D * D * (100 + .5 * 100) * parameters.Gravity.Y), .005);
            Refused(Status.InvalidArgument, "phases[0] is 2", () => fluid.SetParticlePhases(new uint[] { 2 }));
            Refused(Status.InvalidArgument, "phases[0].rest_density is -1", () => fluid.SetPhases(Phase.Of(-1), Phase.Of(1)));
        }
    }

    private static void FieldsAreReadAsRenderersWantThem()
    {
        const Status wrong = Status.InvalidArgument;
        var parameters = Params.Default;
        parameters.Gravity = At(0, 0, 0);
        using (var fluid = new Solver(DescOf(3, 10, Constants.Float64), parameters))
        {
            fluid.AddParticles(new[] { .25, .5, .5, .75, .5, .5 }, new double[] { 3, 0, -4, 0, 0, 0 });
            fluid.KeepPrevious(true);
            fluid.Step();
            var speeds = new Rows { Components = 4, Stride = 5, W = Constants.WSpeed };
            var rows = Enumerable.Repeat(9f, 10).ToArray();
            fluid.Read(Constants.FieldPosition, rows, speeds);
            Near(.25 + 3 * parameters.TimeStep, rows[0], 1e-6);
            Equal("5 9 0.75 9", FormattableString.Invariant($"{rows[3]} {rows[4]} {rows[5]} {rows[9]}"));
            var x = new double[6];
            fluid.Read(Constants.FieldPosition, x, new Rows { Behind = 1 });
            Near(.25, x[0], 0);
            fluid.Read(Constants.FieldPosition, new float[9], speeds); // the last gap may be missing
            Refused(wrong, "8 numbers", () => fluid.Read(Constants.FieldPosition, new float[8], speeds));
            Refused(wrong, "1 numbers", () => fluid.Read(Constants.FieldPosition, new float[1], speeds));
            Refused(wrong, "rows of 3 with 2", () => fluid.Read(Constants.FieldPosition, x, new Rows { Stride = 2 }));
            Refused(wrong, "", () => fluid.Read(Constants.FieldPosition, x, new Rows { First = 1 }));
        }
    }

    // Inside a fluid at rest particles are balls; alone they are half as large.
    private static void AnisotropiesAreOfTheNeighbours()
    {
        using (var fluid = Block())
        {
            float[] x = new float[3], stretches = new float[9];
            fluid.GetAnisotropies(x, stretches, new Anisotropy { First = 555 });
            Near(.275, x[0], 1e-6);
            for (int k = 0; k < 9; ++k) Near(k % 4 == 0 ? 1 : 0, stretches[k], .02);
            fluid.SetPositions(new[] { .9f, .9f, .9f });
            fluid.GetAnisotropies(null, stretches);
            Near(.5, stretches[4], 1e-6);
            Refused(Status.InvalidArgument, "positions has 2 rows, stretches 1", () => fluid.GetAnisotropies(new float[6], stretches));
        }
    }

    private static void WorldsFallAsTheyWouldAlone()
    {
        var parameters = Params.Default;
        double t = 12 * parameters.TimeStep;
        using (var batch = new Batch(3, DescOf(3, 10, Constants.Float64), parameters))
        using (var alone = new Solver(DescOf(3, 10, Constants.Float64), parameters))
        {
            Equal(3u, batch.GetInfo().Worlds);
            batch.AddParticles(new uint[] { 1, 0, 2 }, Enumerable.Repeat(.5, 9).ToArray(), new double[9]);
            Equal("1 0 2", string.Join(" ", batch.GetCounts()));
            batch.SetStart();
            batch.SetGravity(new[] { At(0, -1, 0), At(0, -2, 0), At(3, 0, 0) });
            batch.Step(12, new[] { true, false, true });
            var v = Enumerable.Repeat(9.0, 18).ToArray();
            batch.Read(Constants.FieldVelocity, v);
            Near(-t, v[1], 1e-12);
            Equal(true, v.Skip(3).Take(9).All(number => number == 0)); // rows that worlds have not
            Near(3 * t, v[12], 1e-9);

            parameters.Gravity = At(0, -1, 0);
            alone.AddParticles(new[] { .5, .5, .5 });
            alone.Parameters = parameters;
            alone.Step(12);
            using (var world = batch[0]) Equal(alone.Hash(), world.Hash());
            batch.Reset(new[] { true, false, false });
            using (var world = batch[0])
            {
                var x = new double[3];
                world.GetPositions(x);
                Near(.5, x[1], 0);
                Near(-9.81, world.Parameters.Gravity.Y, 1e-12);
            }
            batch.SetColliders(new[] { Collider.Sphere(At(.2, .2, .2), .1) });
            batch.MoveColliders(Enumerable.Repeat(At(.2, .3, .2), 3).ToArray(), .1);
            batch.Step(12);
            using (var world = batch[1]) Near(.3, world.GetColliders()[0].Position.Y, 1e-9);
        }
    }

    private static void AWorldThatFailsSaysSo()
    {
        const Status wrong = Status.InvalidArgument;
        using (var batch = new Batch(2, DescOf(3, 2)))
        {
            batch.AddParticles(new uint[] { 0, 1 }, new[] { .5f, .5f, .5f });
            using (var world = batch[1])
            using (world.Map(Constants.FieldPosition))
            {
                Refused(Status.State, "world 1: ", () => batch.Step());
                var failures = batch.GetFailures();
                Equal(null, failures[0]);
                Equal(Status.State, failures[1].Status);
                Equal(true, failures[1].Message.Contains("map"));
            }
            Refused(wrong, "mask has 1", () => batch.Step(1, new[] { true }));
            Refused(wrong, "positions has 3", () => batch.AddParticles(new uint[] { 1, 1 }, new float[3]));
            Refused(wrong, "precision", () => batch.AddParticles(new uint[] { 1, 0 }, new double[3]));
            Refused(wrong, "gravity has 1", () => batch.SetGravity(new Vector3d[1]));
            Refused(wrong, "into has 5", () => batch.Read(Constants.FieldPosition, new float[5]));
            Refused(wrong, "orientations has 1", () => batch.MoveColliders(new Vector3d[2], 1, new Vector4d[1]));
            Refused(Status.NotFound, "world is 2", () => batch[2].Step());
        }
        Refused(wrong, "worlds is 0", () => new Batch(0, DescOf(3, 2)));
    }

    // Without drag it falls along a parabola.
    private static void SprayFlies()
    {
        float[] x = { .7f, .9f, .7f, .8f, .9f, .7f }, v = { .5f, 0, 0, 0, .25f, 0 }, times = { 1, 2 };
        using (var fluid = Block())
        {
            Refused(Status.State, "pbf_set_diffuse", () => fluid.AddDiffuse(x, v, times));
            Equal(false, fluid.GetDiffuse().HasValue);
            var wanted = fluid.GetDefaultDiffuse();
            wanted.Capacity = 7;
            wanted.StructSize = 0;
            fluid.SetDiffuse(wanted);
            Equal(7u, fluid.GetDiffuse().Value.Capacity);
            fluid.AddDiffuse(x, v, times);
            fluid.AddDiffuse(new[] { .8f, .8f, .8f }, null, new[] { .01f });
            fluid.ShiftDiffuse(At(0, -.25, 0));
            fluid.Step(8);
            var info = fluid.GetDiffuseInfo();
            Equal(2u, info.Count);
            Equal(2u, info.Spray);
            Equal(1ul, info.Expired);

            double[] at = new double[6], speeds = new double[6], ages = new double[2], lives = new double[2];
            uint[] kinds = { 9, 9 };
            var ids = new ulong[2];
            fluid.ReadDiffuse(0, 2, at, speeds, ages, lives, kinds, ids);
            var parameters = fluid.Parameters;
            double time = 8 * parameters.TimeStep, fall = parameters.Gravity.Y / 2 * time * time;
            Near(.7 + .5 * time, at[0], 1e-6);
            Near(.65 + fall, at[1], 1e-6);
            Near(.65 + .25 * time + fall, at[4], 1e-6);
            Near(.25 + parameters.Gravity.Y * time, speeds[4], 1e-6);
            Near(2 - time, lives[1], 1e-6);
            Near(time, ages[1], 1e-6);
            Equal(Constants.DiffuseSpray, kinds[1]);
            Equal(1ul, ids[1]);
            var left = new float[1];
            fluid.ReadDiffuse(1, 1, lives: left);
            Near(lives[1], left[0], 1e-6);
        }
    }

    private static void WhatIsNoSprayIsRefused()
    {
        using (var fluid = Block())
        {
            var wanted = fluid.GetDefaultDiffuse();
            fluid.SetDiffuse(wanted);
            float[] one = { .7f, .9f, .7f };
            fluid.AddDiffuse(one, null, new[] { 1f });
            var wrong = Status.InvalidArgument;
            Refused(wrong, "lives has 2 elements; it must have 1", () => fluid.ReadDiffuse(0, 1, lives: new float[2]));
            Refused(Status.NotFound, "there are 1 diffuse", () => fluid.ReadDiffuse(1, 1));
            Refused(wrong, "positions has 3 elements; it must have 6", () => fluid.AddDiffuse(one, null, new[] { 1f, 2f }));
            Refused(wrong, "positions is null", () => fluid.AddDiffuse(null, null, new[] { 1f }));
            Refused(wrong, "lives[0]", () => fluid.AddDiffuse(one, null, new[] { 0f }));
            Refused(wrong, "precision", () => fluid.AddDiffuse(new double[3], null, new[] { 1d }));
            wanted.Capacity = 0;
            Refused(wrong, "capacity is 0", () => fluid.SetDiffuse(wanted));
            Equal(1u, fluid.GetDiffuseInfo().Count);
            fluid.SetDiffuse(null);
            Equal(0u, fluid.GetDiffuseInfo().Capacity);
        }
    }

    private static void WorldsAndBatchesGoInAnyOrder()
    {
        var batch = new Batch(2, DescOf(3, 2));
        batch.AddParticles(new uint[] { 1, 1 }, new[] { .5f, .5f, .5f, .5f, .5f, .5f });
        using (var world = batch[0]) world.BeginStep(uint.MaxValue); // which ends with that
        batch.Step();
        var kept = batch[1];
        batch.Dispose();
        kept.Step(); // the batch lives on for it
        Equal(2ul, kept.GetInfo().Step);
        kept.Dispose();
        Thrown<ObjectDisposedException>(() => kept.Step());
        Thrown<ObjectDisposedException>(() => batch.Step());
    }

    private static void ExceptionsOfABatchsLogComeAfterTheCall()
    {
        var parameters = Params.Default;
        parameters.TimeStep = .5; // which the log is told of
        var desc = DescOf(3, 1);
        desc.Log = (level, sentence) => { throw new InvalidTimeZoneException(sentence); };
        using (var batch = new Batch(3, desc, parameters))
        {
            batch.AddParticles(new uint[] { 1, 1, 1 }, Enumerable.Repeat(.5f, 9).ToArray());
            Equal(true, Thrown<InvalidTimeZoneException>(() => batch.Step()).Message.Contains("time_step"));
            batch.Step();
        }
    }
}
