namespace Pbf
{
    // Spray, foam and bubbles, for looks.
    public sealed partial class Solver
    {
        /// <summary>What suits the solver's dimension, SmoothingRadius, Spacing and Gravity.</summary>
        public DiffuseDesc GetDefaultDiffuse()
        {
            var desc = new DiffuseDesc();
            Check(Native.pbf_diffuse_init(handle, ref desc, Arrays.SizeOf<DiffuseDesc>()));
            return desc;
        }

        /// <summary>Has steps make and move them from now on; with null there are none.</summary>
        public void SetDiffuse(DiffuseDesc? wanted)
        {
            object sized = null;
            if (wanted.HasValue)
            {
                var desc = wanted.Value;
                desc.StructSize = Arrays.SizeOf<DiffuseDesc>();
                sized = desc;
            }
            using (var pins = new Pins()) Check(Native.pbf_set_diffuse(handle, pins.Of(sized)));
        }

        /// <summary>What they are made by; null: there are none.</summary>
        public DiffuseDesc? GetDiffuse()
        {
            if (GetDiffuseInfo().Capacity == 0) return null;
            var desc = new DiffuseDesc { StructSize = Arrays.SizeOf<DiffuseDesc>() };
            Check(Native.pbf_get_diffuse(handle, ref desc));
            return desc;
        }

        /// <summary>How many there are, by kind, and what became of others.</summary>
        public DiffuseInfo GetDiffuseInfo()
        {
            var info = new DiffuseInfo { StructSize = Arrays.SizeOf<DiffuseInfo>() };
            Check(Native.pbf_get_diffuse_info(handle, ref info));
            return info;
        }

        /// <summary>
        /// Of `count` of them from number `first` on, the oldest being 0, into arrays for as many each, positions and velocities
        /// with Desc.Dimension numbers of each; null: that is not asked for. Kinds are Constants.DiffuseSpray and so on.
        /// </summary>
        public void ReadDiffuse(uint first, uint count, float[] positions = null, float[] velocities = null, float[] ages = null,
            float[] lives = null, uint[] kinds = null, ulong[] ids = null)
        {
            ReadDiffuse(first, count, Constants.TypeFloat32, positions, velocities, ages, lives, kinds, ids);
        }

        public void ReadDiffuse(uint first, uint count, double[] positions, double[] velocities = null, double[] ages = null,
            double[] lives = null, uint[] kinds = null, ulong[] ids = null)
        {
            ReadDiffuse(first, count, Constants.TypeFloat64, positions, velocities, ages, lives, kinds, ids);
        }

        /// <summary>
        /// Adds your own, as many as `lives` has numbers, the times that they have; without velocities they are at rest.
        /// </summary>
        public void AddDiffuse(float[] positions, float[] velocities, float[] lives) { AddDiffuseOf(positions, velocities, lives); }
        public void AddDiffuse(double[] positions, double[] velocities, double[] lives) { AddDiffuseOf(positions, velocities, lives); }

        /// <summary>Moves all of them, as where the world's origin is moved.</summary>
        public void ShiftDiffuse(Vector3d way)
        {
            using (var pins = new Pins()) Check(Native.pbf_shift_diffuse(handle, pins.Of(way)));
        }

        private void ReadDiffuse(uint first, uint count, uint type, System.Array positions, System.Array velocities, System.Array ages,
            System.Array lives, uint[] kinds, ulong[] ids)
        {
            long numbers = (long)count * dimension;
            Arrays.HasLength("positions", positions, numbers);
            Arrays.HasLength("velocities", velocities, numbers);
            Arrays.HasLength("ages", ages, count);
            Arrays.HasLength("lives", lives, count);
            Arrays.HasLength("kinds", kinds, count);
            Arrays.HasLength("ids", ids, count);
            using (var pins = new Pins())
            {
                var read = new NativeDiffuseRead
                {
                    StructSize = Arrays.SizeOf<NativeDiffuseRead>(), First = first, Count = count, ElementType = type,
                    Positions = pins.Of(positions), Velocities = pins.Of(velocities), Ages = pins.Of(ages), Lives = pins.Of(lives),
                    Kinds = pins.Of(kinds), Ids = pins.Of(ids)
                };
                Check(Native.pbf_read_diffuse(handle, pins.Of(read)));
            }
        }

        private void AddDiffuseOf(System.Array positions, System.Array velocities, System.Array lives)
        {
            long count = Arrays.Given(lives, "lives").Length;
            Arrays.OfPrecision(lives, precision);
            Arrays.HasLength("positions", Arrays.Given(positions, "positions"), count * dimension);
            Arrays.HasLength("velocities", velocities, count * dimension);
            using (var pins = new Pins())
                Check(Native.pbf_add_diffuse(handle, (uint)count, pins.Of(positions), pins.Of(velocities), pins.Of(lives)));
        }
    }
}
