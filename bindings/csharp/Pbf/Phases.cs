namespace Pbf
{
    public partial struct Phase
    {
        /// <summary>A fluid of so much density over the reference density: water 1, oil 0.9.</summary>
        public static Phase Of(double restDensity)
        {
            var made = new Phase();
            PbfException.Check(Native.pbf_phase_init(ref made, Arrays.SizeOf<Phase>()));
            made.RestDensity = restDensity;
            return made;
        }
    }

    // Several fluids in one solver.
    public sealed partial class Solver
    {
        /// <summary>Replaces all phases; with none all particles are alike again.</summary>
        public void SetPhases(params Phase[] phases)
        {
            var sized = (Phase[])Arrays.Given(phases, "phases").Clone();
            for (int i = 0; i < sized.Length; ++i) sized[i].StructSize = Arrays.SizeOf<Phase>();
            using (var pins = new Pins()) Check(Native.pbf_set_phases(handle, (uint)sized.Length, pins.Of(sized)));
        }

        public Phase[] GetPhases()
        {
            uint count = 0;
            Check(Native.pbf_get_phase_count(handle, ref count));
            var phases = new Phase[count];
            for (uint i = 0; i < count; ++i)
            {
                phases[i].StructSize = Arrays.SizeOf<Phase>();
                Check(Native.pbf_get_phase(handle, i, ref phases[i]));
            }
            return phases;
        }

        /// <summary>Which phase particles are of, from row `first` on.</summary>
        public void SetParticlePhases(uint[] phases, uint first = 0)
        {
            Arrays.Given(phases, "phases");
            using (var pins = new Pins())
                Check(Native.pbf_set_particle_phases(handle, first, (uint)phases.Length, pins.Of(phases)));
        }

        public uint[] GetParticlePhases()
        {
            var phases = new uint[Count];
            using (var pins = new Pins())
                Check(Native.pbf_get_particle_phases(handle, 0, (uint)phases.Length, pins.Of(phases)));
            return phases;
        }
    }
}
