using System;
using System.Runtime.InteropServices;
using System.Threading;

namespace Pbf
{
    /// <summary>
    /// A field where the backend has it, in its own order: Ids tells which element is which particle. Until it is
    /// disposed of, calls that change the particles are refused; a solver that is disposed of before lives on for it.
    /// </summary>
    public sealed class View : IDisposable
    {
        private readonly SolverHandle solver;
        private readonly NativeView raw;
        private int mapped; // 1: it is; of threads that give it back at once one does

        internal View(SolverHandle solver, uint field)
        {
            this.solver = solver;
            raw.StructSize = (uint)Marshal.SizeOf(typeof(NativeView));
            bool held = false;
            solver.DangerousAddRef(ref held);
            try
            {
                PbfException.Check(Native.pbf_map(solver, field, ref raw));
                mapped = 1;
            }
            finally
            {
                if (mapped == 0)
                {
                    GC.SuppressFinalize(this);
                    solver.DangerousRelease();
                }
            }
        }

        ~View() { Unmap(); }

        public void Dispose()
        {
            Unmap();
            GC.SuppressFinalize(this);
        }

        public int Count { get { return (int)raw.Count; } }
        public int Components { get { return (int)raw.Components; } }
        public bool OnHost { get { return raw.DeviceType == Constants.DeviceCpu; } }
        /// <summary>Component c of element i is at Data + i * ParticleStride + c * ComponentStride.</summary>
        public IntPtr Data { get { return raw.Data; } }
        public long ParticleStride { get { return raw.ParticleStride; } }
        public long ComponentStride { get { return raw.ComponentStride; } }

        /// <summary>Component c of element i, in host memory.</summary>
        public double At(int i, int c)
        {
            Check(i);
            if (c < 0 || c >= Components) throw new ArgumentOutOfRangeException(nameof(c));
            var at = new IntPtr(raw.Data.ToInt64() + i * raw.ParticleStride + c * raw.ComponentStride);
            double value = raw.ElementType == Constants.TypeFloat64
                ? BitConverter.Int64BitsToDouble(Marshal.ReadInt64(at))
                : BitConverter.ToSingle(BitConverter.GetBytes(Marshal.ReadInt32(at)), 0);
            GC.KeepAlive(this);
            return value;
        }

        /// <summary>Which particle element i is.</summary>
        public uint Id(int i)
        {
            Check(i);
            uint id = (uint)Marshal.ReadInt32(raw.Ids, 4 * i);
            GC.KeepAlive(this);
            return id;
        }

        private void Check(int i)
        {
            if (mapped == 0) throw new ObjectDisposedException(nameof(View));
            if (!OnHost) throw new InvalidOperationException("the view is of a device's memory");
            if (i < 0 || i >= Count) throw new ArgumentOutOfRangeException(nameof(i));
        }

        private void Unmap()
        {
            if (Interlocked.Exchange(ref mapped, 0) == 0) return;
            Native.pbf_unmap(solver.DangerousGetHandle(), raw.Field);
            solver.DangerousRelease();
        }
    }
}
