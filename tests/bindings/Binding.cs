// The C# assembly against the library; the backend is that of PBF_TEST_BACKEND, or "auto".
using System;
using System.Linq;
using System.Runtime.InteropServices;
using System.Threading;
using Pbf;

internal static partial class Binding
{
    private static Desc TestDesc()
    {
        return new Desc
        {
            Backend = Environment.GetEnvironmentVariable("PBF_TEST_BACKEND") ?? "auto", Capacity = 100, Threads = 2
        };
    }

    private static Solver Filled()
    {
        var fluid = new Solver(TestDesc());
        Equal(0u, fluid.AddParticles(new[] { .5f, .5f, .5f, .6f, .5f, .5f }));
        return fluid;
    }

    private static Solver FallingTooFast(Desc desc)
    {
        var parameters = Params.Default;
        parameters.TimeStep = 0.5; // which the log is told of
        var fluid = new Solver(desc, parameters);
        fluid.AddParticles(new[] { .5f, .5f, .5f });
        return fluid;
    }

    private static void Equal<T>(T wanted, T got)
    {
        if (!Equals(wanted, got)) throw new Exception($"{got}, not {wanted}");
    }

    private static void Near(double wanted, double got, double bound)
    {
        if (!(Math.Abs(wanted - got) <= bound)) throw new Exception($"{got}, not {wanted}");
    }

    private static void Refused(Status status, string words, Action call)
    {
        try
        {
            call();
        }
        catch (PbfException refusal)
        {
            Equal(status, refusal.Status);
            if (!refusal.Message.Contains(words)) throw new Exception($"\"{refusal.Message}\" lacks \"{words}\"");
            return;
        }
        throw new Exception($"nothing was refused: {words}");
    }

    private static T Thrown<T>(Action call) where T : Exception
    {
        try { call(); }
        catch (T thrown) { return thrown; }
        throw new Exception($"no {typeof(T)}");
    }

    private static void StructsLieAsInC()
    {
        foreach (var entry in Layout.Structs)
        {
            Equal(entry.Value[0], Marshal.SizeOf(entry.Key).ToString());
            foreach (var field in entry.Value.Skip(1))
            {
                var name = field.Split('=')[0];
                Equal(field, name + "=" + Marshal.OffsetOf(entry.Key, name));
            }
            Equal(entry.Value.Length - 1, entry.Key.GetFields().Length);
        }
    }

    private static void AParticleFalls()
    {
        var parameters = Params.Default;
        parameters.TimeStep = 1.0 / 128;
        var desc = TestDesc();
        desc.Precision = Constants.Float64;
        using (var fluid = new Solver(desc, parameters))
        {
            fluid.AddParticles(new[] { .5, .5, .5 });
            fluid.Step(16);
            var x = new double[3];
            fluid.GetPositions(x);
            // n steps of symplectic Euler: g dt^2 n (n + 1) / 2
            Near(.5 + parameters.Gravity.Y / (128 * 128) * 16 * 17 / 2, x[1], 1e-9);
            fluid.GetVelocities(x);
            Near(parameters.Gravity.Y / 8, x[1], 1e-9);
            Equal(16ul, fluid.GetInfo().Step);
            Equal(1u, fluid.GetStats().Count);
            Near(1.0 / 128, fluid.Parameters.TimeStep, 0);
            Equal(1, fluid.FindInBox(new Vector3d(0, 0, 0), new Vector3d(1, 1, 1)).Length);
            Equal(1u, fluid.RemoveInBox(new Vector3d(0, 0, 0), new Vector3d(1, 1, 1)));
            Equal(0u, fluid.Count);
        }
    }

    // What walls and colliders have had is the momentum that gravity gave and the fluid has not.
    private static void LoadsAreTheMomentumThatIsGone()
    {
        var parameters = Params.Default;
        parameters.Loads = 1;
        var desc = TestDesc();
        desc.Precision = Constants.Float64;
        using (var fluid = new Solver(desc, parameters))
        {
            Equal(0, fluid.GetColliderLoads().Length);
            fluid.AddParticles(new[] { .5, .06, .5, .56, .06, .5 });
            fluid.SetColliders(Collider.Sphere(new Vector3d(.9, .9, .9), .05));
            fluid.Step(16);
            var far = fluid.GetColliderLoads();
            var walls = fluid.GetWallLoads();
            Equal(1, far.Length);
            Equal(6, walls.Length);
            var v = new double[6];
            fluid.GetVelocities(v);
            double volume = Math.Pow(parameters.SmoothingRadius / 2, 3), time = 16 * parameters.TimeStep;
            double gone = volume * (2 * parameters.Gravity.Y * time - v[1] - v[4]);
            Equal(true, gone < -.5 * volume);
            Near(1, walls[Constants.WallYMin].ImpulseSum.Y / gone, 1e-9);
            Near(time, walls[Constants.WallYMin].TimeSum, 1e-12);
            Equal(0u, far[0].Contacts);
            Near(0, far[0].ImpulseSum.Y, 0);
            parameters.Loads = 0;
            fluid.Parameters = parameters;
            Refused(Status.State, "loads", () => fluid.GetWallLoads());
        }
    }

    private static void AccelerationsHoldUp()
    {
        using (var fluid = Filled())
        {
            var v = new float[6];
            fluid.SetAccelerations(new[] { 0, 9.81f, 0 }, 1);
            fluid.Step(12);
            fluid.GetVelocities(v);
            Near(-.981, v[1], 1e-4);
            Near(0, v[4], 1e-6);
            var saved = fluid.Save();
            fluid.ClearAccelerations();
            fluid.Step(12);
            fluid.GetVelocities(v);
            Near(-.981, v[4], 1e-4);
            fluid.Load(saved);
            fluid.Step(12);
            fluid.GetVelocities(v);
            Near(0, v[4], 1e-5);
        }
    }

    private static void ErrorsHaveTheSentence()
    {
        var parameters = Params.Default;
        parameters.TimeStep = -1;
        Refused(Status.InvalidArgument, "time_step", () => new Solver(TestDesc(), parameters));
        var desc = TestDesc();
        desc.Dimension = 4;
        Refused(Status.InvalidArgument, "dimension", () => new Solver(desc));
        desc.Dimension = 3;
        desc.Backend = "ser\0ial";
        Refused(Status.InvalidArgument, "zero character", () => new Solver(desc));
        desc.Backend = "wässer";
        Refused(Status.NotFound, "wässer", () => new Solver(desc));
        using (var fluid = Filled())
        {
            Refused(Status.InvalidArgument, "4 numbers", () => fluid.AddParticles(new float[4]));
            Refused(Status.InvalidArgument, "precision", () => fluid.AddParticles(new double[3]));
            Refused(Status.InvalidArgument, "velocities", () => fluid.AddParticles(new float[3], new float[6]));
            Refused(Status.InvalidArgument, "NaN", () => fluid.AddParticles(new[] { float.NaN, .5f, .5f }));
            Refused(Status.InvalidArgument, "3", () => fluid.GetPositions(new float[9]));
            Refused(Status.InvalidArgument, "is null", () => fluid.AddParticles((float[])null));
            Refused(Status.InvalidArgument, "is null", () => fluid.GetPositions((float[])null));
            Refused(Status.InvalidArgument, "ids is null", () => fluid.RemoveParticles(null));
            Refused(Status.InvalidArgument, "colliders is null", () => fluid.SetColliders(null));
            Refused(Status.InvalidArgument, "state is null", () => fluid.Load(null));
            Refused(Status.NotFound, "7", () => fluid.RemoveParticles(new[] { 7u }));
            Refused(Status.Data, "", () => fluid.Load(new byte[] { 1, 2, 3 }));
            Equal(2u, fluid.Count);
        }
    }

    private static void StructSizesAreSet()
    {
        var parameters = Params.Default;
        parameters.StructSize = 1 << 30;
        using (var fluid = new Solver(TestDesc(), parameters))
        {
            fluid.Parameters = parameters;
            var ball = Collider.Sphere(new Vector3d(.5, .5, .5), .1);
            ball.StructSize = 1 << 30;
            fluid.SetColliders(ball, Collider.Box(new Vector3d(0, 0, 0), new Vector3d(.1, .1, .1)));
            Near(.1, fluid.GetColliders()[1].HalfExtents.Z, 0);
            ball.Position.Y = .6;
            fluid.MoveColliders(new[] { ball, fluid.GetColliders()[1] }, .1);
        }
    }

    private static void ViewsOutliveSolvers()
    {
        var fluid = Filled();
        var view = fluid.Map(Constants.FieldPosition);
        Refused(Status.State, "map", () => fluid.Step());
        fluid.Dispose();
        if (view.OnHost)
        {
            int first = view.Id(0) == 0 ? 0 : 1;
            Near(.5, view.At(first, 0), 1e-6);
            Near(.6, view.At(1 - first, 0), 1e-6);
        }
        Thrown<ArgumentOutOfRangeException>(() => view.At(2, 0));
        view.Dispose();
        view.Dispose();
        Thrown<ObjectDisposedException>(() => view.At(0, 0));
        Thrown<ObjectDisposedException>(() => fluid.Step());
        Thrown<ObjectDisposedException>(() => fluid.Map(Constants.FieldPosition));
        fluid.Dispose();
    }

    private static void SnapshotsOutliveSolvers()
    {
        Snapshot snapshot;
        using (var fluid = Filled())
        {
            fluid.SetSnapshots(2);
            snapshot = fluid.TakeSnapshot();
        }
        var x = new float[6];
        snapshot.CopyPositions(x);
        Near(.6, x[3], 1e-6);
        Refused(Status.InvalidArgument, "precision", () => snapshot.CopyPositions(new double[6]));
        snapshot.Dispose();
        Thrown<ObjectDisposedException>(() => snapshot.CopyPositions(x));
    }

    private static void OtherThreadsCancel()
    {
        using (var fluid = Filled())
        {
            fluid.BeginStep(uint.MaxValue);
            Refused(Status.Busy, "", () => fluid.GetStats());
            var other = new Thread(() => fluid.Cancel());
            other.Start();
            other.Join();
            Refused(Status.Cancelled, "", () => fluid.EndStep());
            fluid.BeginStep(uint.MaxValue);
        } // cancelled, and waited for
    }

    private static void StatesGoOnAlike()
    {
        using (var one = Filled())
        using (var other = new Solver(TestDesc()))
        {
            one.Step(5);
            other.Load(one.Save());
            one.Step(5);
            other.Step(5);
            Equal(one.Hash(), other.Hash());
        }
    }

    private static void TheLogIsHeard()
    {
        string heard = "";
        var desc = TestDesc();
        desc.Log = (level, sentence) => heard += level + sentence;
        using (var fluid = FallingTooFast(desc)) fluid.Step();
        if (!heard.StartsWith("2") || !heard.Contains("time_step")) throw new Exception(heard);
    }

    private static void ExceptionsOfTheLogComeAfterTheCall()
    {
        var desc = TestDesc();
        desc.Log = (level, sentence) => { throw new InvalidTimeZoneException("the log fails"); };
        using (var fluid = FallingTooFast(desc))
        {
            Equal("the log fails", Thrown<InvalidTimeZoneException>(() => fluid.Step()).Message);
            fluid.Step(); // the step was made, and the solver goes on
            Equal(2ul, fluid.GetInfo().Step);
        }
        using (var fluid = FallingTooFast(desc))
        {
            fluid.BeginStep();
            Thrown<InvalidTimeZoneException>(() => fluid.EndStep());
        }
        using (var fluid = FallingTooFast(desc)) fluid.BeginStep();
    }

    // A solver's log is held until it is destroyed.
    private static void WhatIsDroppedIsCollected()
    {
        var logs = new WeakReference[200];
        for (int i = 0; i < logs.Length; ++i)
        {
            Drop(logs, i);
            if (i % 20 == 0) GC.Collect();
        }
        GC.Collect();
        GC.WaitForPendingFinalizers();
        GC.Collect();
        int live = logs.Count(log => log.IsAlive);
        if (live > 20) throw new Exception($"{live} of {logs.Length} solvers are not collected"); // stacks are looked at roughly
    }

    [System.Runtime.CompilerServices.MethodImpl(System.Runtime.CompilerServices.MethodImplOptions.NoInlining)]
    private static void Drop(WeakReference[] logs, int i)
    {
        var heard = new object();
        var desc = TestDesc();
        desc.Log = (level, sentence) => heard.ToString();
        logs[i] = new WeakReference(heard);
        var fluid = new Solver(desc);
        fluid.AddParticles(new[] { .5f, .5f, .5f });
        fluid.SetSnapshots(2);
        fluid.TakeSnapshot();
        fluid.Map(Constants.FieldVelocity);
    }

    private static void PlansAndBackendsAreTold()
    {
        using (var fluid = Filled())
        {
            var plan = fluid.GetPlan();
            Equal(true, plan.Stages.Take((int)plan.StageCount).Any(stage => stage.Name == "predict"));
            fluid.SetTiming(true);
            fluid.Step();
            Equal(true, fluid.GetTimings().Stages[0].Name.Length > 0);
            Equal(true, fluid.GetStepLimit() > 0);
        }
        Equal(true, Solver.Backends(TestDesc()).Any(backend => backend.Available == 1));
        Equal((int)Constants.VersionMinor, Solver.LibraryVersion.Minor);
        Refused(Status.InvalidArgument, "absolute", () => Solver.LoadBackend("water.so"));
        Refused(Status.InvalidArgument, "null", () => Solver.LoadBackend(null));
    }

    private static Solver last, lastLogged, lastWorld;

    private static int Main()
    {
        int failed = 0;
        foreach (var test in new Action[]
        {
            StructsLieAsInC, AParticleFalls, LoadsAreTheMomentumThatIsGone, AccelerationsHoldUp,
            ErrorsHaveTheSentence, StructSizesAreSet, ViewsOutliveSolvers, SnapshotsOutliveSolvers, OtherThreadsCancel, StatesGoOnAlike, TheLogIsHeard,
            ExceptionsOfTheLogComeAfterTheCall, WhatIsDroppedIsCollected, PlansAndBackendsAreTold,
            SprayFlies, WhatIsNoSprayIsRefused, ShapesAreAsFarAsTheirFaces, ShapesComeBackFromBytes, ShapesLiveWhileSomethingHasThem, CollidersHoldTheirShapes, WhatIsNoShapeIsRefused,
            QueriesKnowWaterAtRest, QueriesWantArraysThatFit, AsMuchComesAsTheRateSays, OilFloatsAndTheFloorBearsBoth,
            FieldsAreReadAsRenderersWantThem, AnisotropiesAreOfTheNeighbours,
            TheCollectorRunsInALogOfBegunSteps, ALogOfBegunStepsDisposes, AThreadAbortedInALogEndsAfterTheCall, ViewsAreDroppedBesideCalls, OfTwoThreadsOneGivesBack,
            ASnapshotIsCopiedUntilItIsGivenBack,
            WorldsFallAsTheyWouldAlone, AWorldThatFailsSaysSo, WorldsAndBatchesGoInAnyOrder, ExceptionsOfABatchsLogComeAfterTheCall
        })
        {
            try
            {
                test();
                Console.WriteLine("ok      " + test.Method.Name);
            }
            catch (Exception exception)
            {
                Console.WriteLine("FAILED  " + test.Method.Name + ": " + exception);
                ++failed;
            }
        }
        last = Filled(); // alive, and stepping, when the process ends
        last.BeginStep(uint.MaxValue);
        var desc = TestDesc();
        desc.Log = (level, sentence) => { };
        lastLogged = FallingTooFast(desc); // whose thread has run C#
        lastLogged.BeginStep();
        lastLogged.EndStep();
        lastLogged.BeginStep(uint.MaxValue);
        lastWorld = new Batch(2, TestDesc())[1];
        lastWorld.BeginStep(uint.MaxValue);
        return failed == 0 ? 0 : 1;
    }
}
