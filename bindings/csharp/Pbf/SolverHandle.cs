using System;
using System.Runtime.ExceptionServices;
using System.Runtime.InteropServices;

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
        }

        protected override bool ReleaseHandle()
        {
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
                if (target == null) return;
                lock (target.gate) target.thrown = target.thrown ?? exception;
            }
        }
    }
}
