using System;
using System.Runtime.InteropServices;
using System.Threading;

namespace Pbf
{
    /// <summary>The state after a step. It does not change, and outlives the solver; for any thread.</summary>
    public sealed class Snapshot : IDisposable
    {
        private NativeSnapshot raw;
        private int held; // 1: it is; of threads that release it at once one does

        internal Snapshot(SolverHandle solver)
        {
            raw.StructSize = (uint)Marshal.SizeOf(typeof(NativeSnapshot));
            PbfException.Check(Native.pbf_acquire_snapshot(solver, ref raw));
            held = 1;
        }

        ~Snapshot() { Release(); }

        public void Dispose()
        {
            Release();
            GC.SuppressFinalize(this);
        }

        public int Count { get { return (int)raw.Count; } }
        public ulong Step { get { return raw.Step; } }
        public double Time { get { return raw.Time; } }

        /// <summary>Copies as much as the array has room for.</summary>
        public void CopyPositions(float[] into) { Copy(raw.Positions, into); }
        public void CopyVelocities(float[] into) { Copy(raw.Velocities, into); }
        public void CopyPositions(double[] into) { Copy(raw.Positions, into); }
        public void CopyVelocities(double[] into) { Copy(raw.Velocities, into); }

        private void Copy(IntPtr from, Array into)
        {
            if (held == 0) throw new ObjectDisposedException(nameof(Snapshot));
            if ((into is float[]) != (raw.ElementType == Constants.TypeFloat32))
                throw PbfException.Invalid("the array is not of the solver's precision");
            int numbers = (int)Math.Min(into.Length, raw.Count * (long)raw.Dimension);
            if (numbers == 0) return;
            if (into is float[] floats) Marshal.Copy(from, floats, 0, numbers);
            else Marshal.Copy(from, (double[])into, 0, numbers);
            GC.KeepAlive(this);
        }

        private void Release()
        {
            if (Interlocked.Exchange(ref held, 0) == 1) Native.pbf_release_snapshot(ref raw);
        }
    }
}
