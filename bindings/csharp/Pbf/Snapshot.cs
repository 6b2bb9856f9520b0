using System;
using System.Runtime.InteropServices;

namespace Pbf
{
    /// <summary>The state after a step. It does not change, and outlives the solver; for any thread.</summary>
    public sealed class Snapshot : IDisposable
    {
        private readonly object gate = new object(); // of threads that release it at once one does, and none copies beside it
        private NativeSnapshot raw;
        private bool held;

        internal Snapshot(SolverHandle solver)
        {
            raw.StructSize = (uint)Marshal.SizeOf(typeof(NativeSnapshot));
            PbfException.Check(Native.pbf_acquire_snapshot(solver, ref raw));
            held = true;
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
        public void CopyPositions(float[] into) { Copy(into, false); }
        public void CopyVelocities(float[] into) { Copy(into, true); }
        public void CopyPositions(double[] into) { Copy(into, false); }
        public void CopyVelocities(double[] into) { Copy(into, true); }

        private void Copy(Array into, bool velocities)
        {
            Arrays.Given(into, "into");
            lock (gate)
            {
                if (!held) throw new ObjectDisposedException(nameof(Snapshot));
                if ((into is float[]) != (raw.ElementType == Constants.TypeFloat32))
                    throw PbfException.Invalid("the array is not of the solver's precision");
                int numbers = (int)Math.Min(into.Length, raw.Count * (long)raw.Dimension);
                if (numbers == 0) return;
                var from = velocities ? raw.Velocities : raw.Positions;
                if (into is float[] floats) Marshal.Copy(from, floats, 0, numbers);
                else Marshal.Copy(from, (double[])into, 0, numbers);
            }
            GC.KeepAlive(this);
        }

        private void Release()
        {
            lock (gate)
            {
                if (held) Native.pbf_release_snapshot(ref raw);
                held = false;
            }
        }
    }
}
