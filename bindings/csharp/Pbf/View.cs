using System;
using System.Runtime.InteropServices;

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
        private bool mapped;

        internal View(SolverHandle solver, uint field)
        {
            this.solver = solver;
            raw.StructSize = (uint)Marshal.SizeOf(typeof(NativeView));
            bool held = false;
            solver.DangerousAddRef(ref held);
            try
            {
                PbfException.Check(Native.pbf_map(solver, field, ref raw));
                mapped = true;
            }
            finally
            {
                if (!mapped)
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
            if (raw.ElementType == Constants.TypeFloat64)
                return BitConverter.Int64BitsToDouble(Marshal.ReadInt64(at));
            return BitConverter.ToSingle(BitConverter.GetBytes(Marshal.ReadInt32(at)), 0);
        }

        /// <summary>Which particle element i is.</summary>
        public uint Id(int i)
        {
            Check(i);
            return (uint)Marshal.ReadInt32(raw.Ids, 4 * i);
        }

        private void Check(int i)
        {
            if (!mapped) throw new ObjectDisposedException(nameof(View));
            if (!OnHost) throw new InvalidOperationException("the view is of a device's memory");
            if (i < 0 || i >= Count) throw new ArgumentOutOfRangeException(nameof(i));
        }

        private void Unmap()
        {
            if (!mapped) return;
            mapped = false;
            Native.pbf_unmap(solver.DangerousGetHandle(), raw.Field);
            solver.DangerousRelease();
        }
    }
}
