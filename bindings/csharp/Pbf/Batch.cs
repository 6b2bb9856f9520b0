using System;
using System.Runtime.InteropServices;

namespace Pbf
{
    /// <summary>
    /// Many worlds of one kind in one call. Arrays are world after world; a mask has a truth value a world, and null is
    /// all of them. Where a world fails the others go on, and the call throws what the first one met. A log is called
    /// from all of a batch's threads at once.
    /// </summary>
    public sealed class Batch : IDisposable
    {
        private readonly BatchHandle handle = new BatchHandle();
        private readonly LogTarget log;
        private readonly uint worlds, dimension, precision;

        /// <summary>So many empty worlds, each as a Solver would be; Desc.Threads step them.</summary>
        public Batch(uint worlds, Desc desc = null, Params? parameters = null)
        {
            desc = desc ?? new Desc();
            this.worlds = worlds;
            dimension = desc.Dimension;
            precision = desc.Precision;
            log = LogTarget.Make(desc.Log, out var target);
            try
            {
                handle.Own(desc.Create(parameters, target, (IntPtr raw, IntPtr first, out IntPtr made) =>
                    Native.pbf_batch_create(raw, first, worlds, out made)), target);
            }
            catch
            {
                GC.SuppressFinalize(handle);
                if (target.IsAllocated) target.Free();
                throw;
            }
            LogTarget.ThrowOn(log);
        }

        /// <summary>A world whose Solver is not disposed of lives on for that.</summary>
        public void Dispose() { handle.Dispose(); }

        /// <summary>How many worlds there are.</summary>
        public uint Count { get { return worlds; } }

        public BatchInfo GetInfo()
        {
            var info = new BatchInfo { StructSize = Arrays.SizeOf<BatchInfo>() };
            Check(Native.pbf_batch_get_info(handle, ref info));
            return info;
        }

        /// <summary>A world as a solver, between calls of the batch.</summary>
        public Solver this[uint world]
        {
            get
            {
                Check(Native.pbf_batch_get_world(handle, world, out IntPtr solver));
                return new Solver(solver, handle, log, dimension, precision);
            }
        }

        /// <summary>Of each world what it met in the last call that went through worlds; null: nothing.</summary>
        public PbfException[] GetFailures()
        {
            var statuses = new int[worlds];
            using (var pins = new Pins()) Check(Native.pbf_batch_get_statuses(handle, pins.Of(statuses)));
            var failures = new PbfException[worlds];
            for (uint world = 0; world < worlds; ++world)
            {
                if (statuses[world] == 0) continue;
                Check(Native.pbf_batch_get_sentence(handle, world, out IntPtr sentence));
                failures[world] = new PbfException((Status)statuses[world], Text.From(sentence));
            }
            return failures;
        }

        // ---- Steps and starts

        public void Step(uint steps = 1, bool[] mask = null)
        {
            using (var pins = new Pins()) Check(Native.pbf_batch_step(handle, Mask(pins, mask), steps));
        }

        /// <summary>What Reset goes back to: a state of Solver.Save, or the present one of each.</summary>
        public void SetStart(byte[] state = null, bool[] mask = null)
        {
            using (var pins = new Pins())
                Check(Native.pbf_batch_set_start(handle, Mask(pins, mask), pins.Of(state), (ulong)(state == null ? 0 : state.Length)));
        }

        public void Reset(bool[] mask = null)
        {
            using (var pins = new Pins()) Check(Native.pbf_batch_reset(handle, Mask(pins, mask)));
        }

        // ---- Actions

        /// <summary>Of each world.</summary>
        public void SetGravity(Vector3d[] gravity, bool[] mask = null)
        {
            OfEachWorld("gravity", Arrays.Given(gravity, "gravity"), 1);
            using (var pins = new Pins()) Check(Native.pbf_batch_set_gravity(handle, Mask(pins, mask), pins.Of(gravity)));
        }

        /// <summary>The same ones for all.</summary>
        public void SetColliders(Collider[] colliders, bool[] mask = null)
        {
            var raw = Arrays.Colliders(colliders, "colliders");
            using (var pins = new Pins())
                Check(Native.pbf_batch_set_colliders(handle, Mask(pins, mask), (uint)raw.Length, pins.Of(raw)));
            GC.KeepAlive(colliders);
        }

        /// <summary>All that each world has, world after world; without orientations they keep theirs.</summary>
        public void MoveColliders(Vector3d[] positions, double duration, Vector4d[] orientations = null, bool[] mask = null)
        {
            uint count = (uint)Arrays.Given(positions, "positions").Length / worlds;
            OfEachWorld("positions", positions, count);
            OfEachWorld("orientations", orientations, count);
            using (var pins = new Pins())
                Check(Native.pbf_batch_move_colliders(handle, Mask(pins, mask), count, pins.Of(positions), pins.Of(orientations), duration));
        }

        /// <summary>So many to each world; without velocities they are at rest.</summary>
        public void AddParticles(uint[] counts, float[] positions, float[] velocities = null) { Add(counts, positions, velocities); }
        public void AddParticles(uint[] counts, double[] positions, double[] velocities = null) { Add(counts, positions, velocities); }

        // ---- Observations

        /// <summary>Particles of each world.</summary>
        public uint[] GetCounts()
        {
            var counts = new uint[worlds];
            using (var pins = new Pins()) Check(Native.pbf_batch_get_counts(handle, pins.Of(counts)));
            return counts;
        }

        /// <summary>
        /// A field of each world, Constants.FieldPosition and so on, in as many rows as the array has room for; rows that a
        /// world lacks are 0.
        /// </summary>
        public void Read(uint field, float[] into, bool[] mask = null) { Rows(field, into, mask); }
        public void Read(uint field, double[] into, bool[] mask = null) { Rows(field, into, mask); }

        // ---- What the calls have in common

        private void Add(uint[] counts, Array positions, Array velocities)
        {
            OfEachWorld("counts", Arrays.Given(counts, "counts"), 1);
            long numbers = 0;
            foreach (uint count in counts) numbers += (long)count * dimension;
            Arrays.HasLength("positions", Arrays.Given(positions, "positions"), numbers);
            Arrays.HasLength("velocities", velocities, numbers);
            Arrays.OfPrecision(positions, precision);
            using (var pins = new Pins())
                Check(Native.pbf_batch_add_particles(handle, pins.Of(counts), pins.Of(positions), pins.Of(velocities)));
        }

        private void Rows(uint field, Array into, bool[] mask)
        {
            Arrays.OfPrecision(Arrays.Given(into, "into"), precision);
            bool vector = field == Constants.FieldPosition || field == Constants.FieldVelocity;
            uint width = vector ? dimension : 1, rows = (uint)into.Length / (worlds * width);
            OfEachWorld("into", into, rows * width);
            using (var pins = new Pins())
            {
                var read = new NativeReadDesc
                {
                    StructSize = Arrays.SizeOf<NativeReadDesc>(), Field = field, Count = rows, ElementType = precision,
                    Data = pins.Of(into)
                };
                Check(Native.pbf_batch_read(handle, Mask(pins, mask), pins.Of(read), 0));
            }
        }

        private IntPtr Mask(Pins pins, bool[] mask)
        {
            OfEachWorld("mask", mask, 1);
            return pins.Of(mask == null ? null : Array.ConvertAll(mask, chosen => chosen ? (byte)1 : (byte)0));
        }

        private void OfEachWorld(string name, Array array, uint each)
        {
            if (array != null && array.Length != (long)worlds * each)
                throw PbfException.Invalid($"{name} has {array.Length} elements, not as many for each of {worlds} worlds");
        }

        private void Check(Status status)
        {
            if (status != Status.Busy) LogTarget.ThrowOn(log); // steps that have begun tell at their end
            PbfException.Check(status);
        }
    }

    /// <summary>The batch of C. It is destroyed when nothing uses it any more, its worlds included.</summary>
    internal sealed class BatchHandle : SafeHandle
    {
        private GCHandle log; // of a LogTarget, which the library's calls name

        internal BatchHandle() : base(IntPtr.Zero, true) { }

        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }

        internal void Own(IntPtr batch, GCHandle target)
        {
            SetHandle(batch);
            log = target;
            if (log.IsAllocated) AtExit.Add(this);
        }

        protected override bool ReleaseHandle()
        {
            AtExit.Remove(this);
            Native.pbf_batch_destroy(handle);
            if (log.IsAllocated) log.Free();
            return true;
        }
    }
}
