// What the runtime does beside the library: its collector, its signals, its threads.
using System;
using System.Collections.Generic;
using System.Runtime.CompilerServices;
using System.Threading;
using Pbf;

internal static partial class Binding
{
    // The collector stops each thread that runs C#, by a signal, and makes an exception of a fault's.
    private static void TheCollectorRunsInALogOfBegunSteps()
    {
        string missing = null;
        var desc = TestDesc();
        int heard = 0;
        desc.Log = (level, sentence) =>
        {
            ++heard;
            for (int i = 0; i < 3; ++i) GC.Collect();
            heard += missing.Length;
        };
        using (var fluid = FallingTooFast(desc))
        {
            fluid.BeginStep();
            Thrown<NullReferenceException>(() => fluid.EndStep());
            Equal(1, heard);
            for (int i = 0; i < 3; ++i) GC.Collect(); // beside the thread that waits for steps
            fluid.BeginStep();
            fluid.EndStep();
        }
        using (var worlds = new Batch(8, desc))
        {
            var parameters = worlds[0].Parameters;
            parameters.TimeStep = .5;
            for (uint world = 0; world < worlds.Count; ++world)
            {
                worlds[world].Parameters = parameters;
                worlds[world].AddParticles(new[] { .5f, .5f, .5f });
            }
            Thrown<NullReferenceException>(() => worlds.Step());
            for (int i = 0; i < 3; ++i) GC.Collect();
        }
    }

    // Unity aborts threads when it loads programs anew.
    private static void AThreadAbortedInALogEndsAfterTheCall()
    {
        bool ended = false;
        var desc = TestDesc();
        desc.Log = (level, sentence) => Thread.CurrentThread.Abort();
        using (var fluid = FallingTooFast(desc))
        {
            var thread = new Thread(() =>
            {
                try
                {
                    fluid.Step();
                }
                catch (ThreadAbortException)
                {
                    ended = true;
                    Thread.ResetAbort();
                }
            });
            thread.Start();
            thread.Join();
            Equal(true, ended);
            Equal(1ul, fluid.GetInfo().Step); // the step has come to its end
            fluid.Step();
        }
    }

    private static void ALogOfBegunStepsDisposes()
    {
        Solver fluid = null;
        int heard = 0;
        var desc = TestDesc();
        var done = new ManualResetEvent(false);
        desc.Log = (level, sentence) =>
        {
            ++heard;
            fluid.Dispose();
            done.Set();
        };
        fluid = FallingTooFast(desc);
        var parameters = fluid.Parameters;
        parameters.Attraction = 20; // which steps are too long for, too
        fluid.Parameters = parameters;
        fluid.BeginStep(uint.MaxValue);
        done.WaitOne();
        Thrown<ObjectDisposedException>(() => fluid.EndStep());
        Equal(1, heard);
    }

    [MethodImpl(MethodImplOptions.NoInlining)]
    private static void DropViews(Solver fluid)
    {
        for (int i = 0; i < 50; ++i) fluid.Map(Constants.FieldPosition);
    }

    // The collector's thread gives them back, and meets calls of this one.
    private static void ViewsAreDroppedBesideCalls()
    {
        bool stop = false;
        var collector = new Thread(() => { while (!Volatile.Read(ref stop)) GC.Collect(); });
        using (var fluid = new Solver(TestDesc()))
        {
            var x = new float[300];
            for (int i = 0; i < x.Length; ++i) x[i] = .1f + .08f * (i % 3 == 0 ? i / 3 % 10 : i % 3 == 1 ? i / 30 : 5);
            fluid.AddParticles(x);
            collector.Start();
            for (int i = 0; i < 20; ++i)
            {
                DropViews(fluid);
                for (int k = 0; k < 20; ++k) fluid.GetStats();
            }
            Volatile.Write(ref stop, true);
            collector.Join();
            for (int i = 0; ; ++i)
            {
                GC.Collect();
                GC.WaitForPendingFinalizers();
                try
                {
                    fluid.Step();
                    break;
                }
                catch (PbfException refusal) when (refusal.Status == Status.State && i < 200)
                {
                    // stacks are looked at roughly: some few views may seem to be in use
                    if (i > 100 && int.Parse(refusal.Message.Split(' ')[0]) < 20) break;
                }
            }
        }
    }

    private static void CopyUntilItIsGone(Snapshot snapshot, List<Exception> failures)
    {
        var into = new float[6];
        try
        {
            while (true)
            {
                snapshot.CopyPositions(into);
                if (into[0] != .5f || into[3] != .6f) throw new Exception($"a snapshot has {into[0]} and {into[3]}");
            }
        }
        catch (ObjectDisposedException) { }
        catch (Exception failure) { lock (failures) failures.Add(failure); }
    }

    private static void ASnapshotIsCopiedUntilItIsGivenBack()
    {
        var failures = new List<Exception>();
        using (var fluid = Filled())
        {
            fluid.SetSnapshots(3);
            for (int i = 0; i < 300; ++i)
            {
                var snapshot = fluid.TakeSnapshot();
                var threads = new[] { new Thread(() => CopyUntilItIsGone(snapshot, failures)), new Thread(() => CopyUntilItIsGone(snapshot, failures)) };
                foreach (var thread in threads) thread.Start();
                Thread.Yield();
                snapshot.Dispose();
                foreach (var thread in threads) thread.Join();
            }
        }
        if (failures.Count > 0) throw failures[0];
    }

    private static void OfTwoThreadsOneGivesBack()
    {
        for (int i = 0; i < 300; ++i)
        {
            using (var fluid = Filled())
            {
                fluid.SetSnapshots(2);
                var view = fluid.Map(Constants.FieldPosition);
                var snapshot = fluid.TakeSnapshot();
                int waiting = 2;
                ThreadStart give = () =>
                {
                    Interlocked.Decrement(ref waiting);
                    while (Volatile.Read(ref waiting) > 0) continue;
                    snapshot.Dispose();
                    view.Dispose();
                };
                var threads = new[] { new Thread(give), new Thread(give) };
                foreach (var thread in threads) thread.Start();
                foreach (var thread in threads) thread.Join();
                fluid.Step();
                using (fluid.TakeSnapshot()) fluid.GetStats();
            }
        }
    }
}
