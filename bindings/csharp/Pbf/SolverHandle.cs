using System;
using System.Runtime.InteropServices;

namespace Pbf
{
    /// <summary>
    /// The solver of C. It is destroyed when nothing uses it any more: no call is inside, and views are gone.
    /// </summary>
    internal sealed class SolverHandle : SafeHandle
    {
        private GCHandle log; // of a LogTarget, which the library's calls name

        internal SolverHandle() : base(IntPtr.Zero, true) { }

        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }

        internal void Own(IntPtr solver, GCHandle target)
        {
            SetHandle(solver);
            log = target;
        }

        protected override bool ReleaseHandle()
        {
            Native.pbf_destroy(handle);
            if (log.IsAllocated) log.Free();
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

        internal LogTarget(Action<uint, string> call) { this.call = call; }

        internal Exception Take()
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
