using System;
using System.Collections.Generic;
using System.Runtime.ExceptionServices;
using System.Runtime.InteropServices;
using System.Threading;

namespace Pbf
{
    /// <summary>
    /// The solver of C. It is destroyed when nothing uses it any more: no call is inside, and views are gone.
    /// </summary>
    internal sealed class SolverHandle : SafeHandle
    {
        private GCHandle log;      // of a LogTarget, which the library's calls name
        private BatchHandle batch; // that it is a world of, and ends with

        internal SolverHandle() : base(IntPtr.Zero, true) { }

        internal SolverHandle(IntPtr world, BatchHandle batch) : base(IntPtr.Zero, true)
        {
            bool held = false;
            batch.DangerousAddRef(ref held);
            this.batch = batch;
            SetHandle(world);
        }

        internal bool IsWorld { get { return batch != null; } }

        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }

        internal void Own(IntPtr solver, GCHandle target)
        {
            SetHandle(solver);
            log = target;
            if (log.IsAllocated) AtExit.Add(this);
        }

        protected override bool ReleaseHandle()
        {
            AtExit.Remove(this);
            Native.pbf_destroy(handle); // of a world nothing
            if (log.IsAllocated) log.Free();
            if (batch != null) batch.DangerousRelease();
            return true;
        }
    }

    /// <summary>Compilers ahead of time (IL2CPP) look for an attribute of this name.</summary>
    [AttributeUsage(AttributeTargets.Method)]
    internal sealed class MonoPInvokeCallbackAttribute : Attribute
    {
        public MonoPInvokeCallbackAttribute(Type type) { Type = type; }
        public Type Type { get; }
    }

    /// <summary>
    /// Solvers and batches with a log. Their threads have run C# when they have called it, and Mono waits, when the
    /// process ends, until no such thread is left.
    /// </summary>
    internal static class AtExit
    {
        private static readonly Dictionary<IntPtr, WeakReference> live = Listen();

        internal static void Add(SafeHandle handle)
        {
            lock (live) live[handle.DangerousGetHandle()] = new WeakReference(handle, true);
        }

        internal static void Remove(SafeHandle handle)
        {
            lock (live) live.Remove(handle.DangerousGetHandle());
        }

        private static Dictionary<IntPtr, WeakReference> Listen()
        {
            AppDomain.CurrentDomain.ProcessExit += (sender, arguments) => End();
            return new Dictionary<IntPtr, WeakReference>();
        }

        private static void End()
        {
            WeakReference[] left;
            lock (live)
            {
                left = new WeakReference[live.Count];
                live.Values.CopyTo(left, 0);
            }
            foreach (var reference in left) ((SafeHandle)reference.Target)?.Dispose();
        }
    }

    /// <summary>What the library's log calls, and the first thing it threw that was not thrown on yet.</summary>
    internal sealed class LogTarget
    {
        internal static readonly LogFn Write = Called;
        private readonly Action<uint, string> call;
        private readonly object gate = new object();
        private Exception thrown;

        private LogTarget(Action<uint, string> call) { this.call = call; }

        /// <summary>Null without a log; what the library's calls name is to be freed.</summary>
        internal static LogTarget Make(Action<uint, string> call, out GCHandle named)
        {
            named = default(GCHandle);
            if (call == null) return null;
            var made = new LogTarget(call);
            named = GCHandle.Alloc(made);
            return made;
        }

        internal static void ThrowOn(LogTarget log)
        {
            var thrown = log?.Take();
            if (thrown is ThreadAbortException) Thread.CurrentThread.Abort();
            if (thrown != null) ExceptionDispatchInfo.Capture(thrown).Throw();
        }

        private Exception Take()
        {
            lock (gate)
            {
                var taken = thrown;
                thrown = null;
                return taken;
            }
        }

        [MonoPInvokeCallback(typeof(LogFn))]
        private static void Called(IntPtr user, int level, IntPtr message)
        {
            LogTarget target = null;
            try
            {
                target = (LogTarget)GCHandle.FromIntPtr(user).Target;
                target.call((uint)level, Text.From(message));
            }
            catch (Exception exception)
            {
                // An abort would go on where this ends, through the library: it begins anew after the call.
                if (exception is ThreadAbortException) Thread.ResetAbort();
                if (target == null) return;
                lock (target.gate) target.thrown = target.thrown ?? exception;
            }
        }
    }
}
