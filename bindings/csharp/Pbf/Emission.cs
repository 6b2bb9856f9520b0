namespace Pbf
{
    public partial struct Emitter
    {
        /// <summary>Across the stream; as much comes as it carries, unless Rate says less.</summary>
        public static Emitter Rectangle(Vector3d center, Vector3d velocity, double halfWidth, double halfHeight)
        {
            var made = Of(Constants.EmitterRectangle, center, velocity);
            made.HalfWidth = halfWidth;
            made.HalfHeight = halfHeight;
            return made;
        }

        public static Emitter Disc(Vector3d center, Vector3d velocity, double radius)
        {
            var made = Of(Constants.EmitterDisc, center, velocity);
            made.Radius = radius;
            return made;
        }

        private static Emitter Of(uint shape, Vector3d center, Vector3d velocity)
        {
            var made = new Emitter();
            PbfException.Check(Native.pbf_emitter_init(ref made, Arrays.SizeOf<Emitter>(), shape));
            made.Position = center;
            made.Velocity = velocity;
            return made;
        }
    }

    public partial struct Reservoir
    {
        /// <summary>A box in which fluid always stands so deep; Pressure, Orientation and Phase may be set.</summary>
        public static Reservoir Box(Vector3d center, Vector3d halfExtents, double depth)
        {
            var made = new Reservoir();
            PbfException.Check(Native.pbf_reservoir_init(ref made, Arrays.SizeOf<Reservoir>()));
            made.Position = center;
            made.HalfExtents = halfExtents;
            made.Depth = depth;
            return made;
        }
    }

    // What comes and goes in each step.
    public sealed partial class Solver
    {
        /// <summary>Replaces all emitters; each goes on where it was before, whatever its number.</summary>
        public void SetEmitters(params Emitter[] emitters)
        {
            var sized = (Emitter[])Arrays.Given(emitters, "emitters").Clone();
            for (int i = 0; i < sized.Length; ++i) sized[i].StructSize = Arrays.SizeOf<Emitter>();
            using (var pins = new Pins()) Check(Native.pbf_set_emitters(handle, (uint)sized.Length, pins.Of(sized)));
        }

        public Emitter[] GetEmitters()
        {
            var emitters = new Emitter[GetInOut().Emitters];
            for (uint i = 0; i < emitters.Length; ++i)
            {
                emitters[i].StructSize = Arrays.SizeOf<Emitter>();
                Check(Native.pbf_get_emitter(handle, i, ref emitters[i]));
            }
            return emitters;
        }

        /// <summary>What is in one of these volumes when a step begins is removed.</summary>
        public void SetDrains(params Volume[] drains)
        {
            var sized = (Volume[])Arrays.Given(drains, "drains").Clone();
            for (int i = 0; i < sized.Length; ++i) sized[i].StructSize = Arrays.SizeOf<Volume>();
            using (var pins = new Pins()) Check(Native.pbf_set_drains(handle, (uint)sized.Length, pins.Of(sized)));
        }

        public Volume[] GetDrains()
        {
            var drains = new Volume[GetInOut().Drains];
            for (uint i = 0; i < drains.Length; ++i)
            {
                drains[i].StructSize = Arrays.SizeOf<Volume>();
                Check(Native.pbf_get_drain(handle, i, ref drains[i]));
            }
            return drains;
        }

        /// <summary>Replaces all open boundaries of given level or pressure.</summary>
        public void SetReservoirs(params Reservoir[] reservoirs)
        {
            var sized = (Reservoir[])Arrays.Given(reservoirs, "reservoirs").Clone();
            for (int i = 0; i < sized.Length; ++i) sized[i].StructSize = Arrays.SizeOf<Reservoir>();
            using (var pins = new Pins()) Check(Native.pbf_set_reservoirs(handle, (uint)sized.Length, pins.Of(sized)));
        }

        public Reservoir[] GetReservoirs()
        {
            uint count = 0;
            Check(Native.pbf_get_reservoir_count(handle, ref count));
            var reservoirs = new Reservoir[count];
            for (uint i = 0; i < count; ++i)
            {
                reservoirs[i].StructSize = Arrays.SizeOf<Reservoir>();
                Check(Native.pbf_get_reservoir(handle, i, ref reservoirs[i]));
            }
            return reservoirs;
        }

        /// <summary>What came and went, in particles.</summary>
        public InOut GetInOut()
        {
            var got = new InOut { StructSize = Arrays.SizeOf<InOut>() };
            Check(Native.pbf_get_in_out(handle, ref got));
            return got;
        }
    }
}
