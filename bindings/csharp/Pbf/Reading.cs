using System;

namespace Pbf
{
    /// <summary>Which rows Solver.Read writes, and how: the fields of pbf_read_desc, all 0 by default.</summary>
    public struct Rows
    {
        public uint First;
        /// <summary>Numbers of a particle; 0: as many as the field has.</summary>
        public uint Components;
        /// <summary>From a row to the next, in numbers; 0: no gap.</summary>
        public uint Stride;
        /// <summary>What the fourth of four numbers is: Constants.WSpeed and so on.</summary>
        public uint W;
        public double WValue;
        /// <summary>Constants.OrderAdded or OrderStored.</summary>
        public uint Order;
        /// <summary>How far back between the last two steps; wants KeepPrevious.</summary>
        public double Behind;
    }

    /// <summary>How particles are smoothed and stretched: the fields of pbf_anisotropy_desc; 0: the paper's.</summary>
    public struct Anisotropy
    {
        public uint First;
        public uint MinNeighbors;
        public double Radius;
        public double Smoothing;
        public double MaxRatio;
        public double LoneScale;
    }

    // What renderers take.
    public sealed partial class Solver
    {
        /// <summary>
        /// A field, Constants.FieldPosition and so on, of as many particles as the array has room for, in numbers of its
        /// type; what lies between rows stays as it is.
        /// </summary>
        public void Read(uint field, float[] into, Rows rows = default(Rows)) { ReadRows(field, into, Constants.TypeFloat32, 4, rows); }
        public void Read(uint field, double[] into, Rows rows = default(Rows)) { ReadRows(field, into, Constants.TypeFloat64, 8, rows); }

        /// <summary>Keeps the positions from before the last step, for Rows.Behind.</summary>
        public void KeepPrevious(bool enabled) { Check(Native.pbf_keep_previous(handle, enabled ? 1u : 0u)); }

        /// <summary>Smoothed positions, Desc.Dimension numbers each, and matrices, as many squared; null: not asked for.</summary>
        public void GetAnisotropies(float[] positions, float[] stretches, Anisotropy wanted = default(Anisotropy)) { Stretch(positions, stretches, wanted); }
        public void GetAnisotropies(double[] positions, double[] stretches, Anisotropy wanted = default(Anisotropy)) { Stretch(positions, stretches, wanted); }

        private void ReadRows(uint field, Array into, uint type, uint size, Rows rows)
        {
            long has = Arrays.Given(into, "into").Length;
            bool vector = field == Constants.FieldPosition || field == Constants.FieldVelocity;
            long width = rows.Components != 0 ? rows.Components : vector ? dimension : 1, stride = rows.Stride != 0 ? rows.Stride : width;
            long count = has < width ? 0 : (has - width) / stride + 1, end = count == 0 ? 0 : (count - 1) * stride + width;
            // The gap may be behind the last row, too.
            if (width > stride || (has != end && (count == 0 || has - end != stride - width)))
                throw PbfException.Invalid($"into has {has} numbers, which are no rows of {width} with {stride} from one to the next");
            using (var pins = new Pins())
            {
                var read = new NativeReadDesc
                {
                    StructSize = Arrays.SizeOf<NativeReadDesc>(), Field = field, First = rows.First, Count = (uint)count, ElementType = type,
                    Components = rows.Components, W = rows.W, WValue = rows.WValue, Order = rows.Order, Behind = rows.Behind,
                    Stride = (ulong)rows.Stride * size, Data = pins.Of(into)
                };
                Check(Native.pbf_read(handle, pins.Of(read)));
            }
        }

        private void Stretch(Array positions, Array stretches, Anisotropy wanted)
        {
            uint count = 0;
            if (stretches != null) count = ParticlesOf(stretches, dimension * dimension);
            if (positions != null)
            {
                uint rows = ParticlesOf(positions, dimension);
                if (stretches != null && rows != count) throw PbfException.Invalid($"positions has {rows} rows, stretches {count}");
                count = rows;
            }
            using (var pins = new Pins())
            {
                var raw = new NativeAnisotropyDesc
                {
                    StructSize = Arrays.SizeOf<NativeAnisotropyDesc>(), First = wanted.First, Count = count, MinNeighbors = wanted.MinNeighbors,
                    Radius = wanted.Radius, Smoothing = wanted.Smoothing, MaxRatio = wanted.MaxRatio, LoneScale = wanted.LoneScale,
                    Positions = pins.Of(positions), Stretches = pins.Of(stretches)
                };
                Check(Native.pbf_get_anisotropies(handle, pins.Of(raw)));
            }
        }
    }
}
