using System;

namespace Pbf
{
    /// <summary>
    /// A fluid. Arrays have the coordinates of a particle one after the other, Desc.Dimension of them, as float[]
    /// or double[] by Desc.Precision. A call that fails throws a PbfException and leaves the solver as it was.
    /// One thread at a time uses it; Cancel and TakeSnapshot are for any thread, at any time.
    /// </summary>
    public sealed partial class Solver : IDisposable
    {
        private readonly SolverHandle handle;
        private readonly LogTarget log;
        private readonly uint dimension;
        private readonly uint precision;

        public Solver(Desc desc = null, Params? parameters = null)
        {
            desc = desc ?? new Desc();
            handle = new SolverHandle();
            dimension = desc.Dimension;
            precision = desc.Precision;
            log = LogTarget.Make(desc.Log, out var target);
            try
            {
                handle.Own(desc.Create(parameters, target, Native.pbf_create), target);
            }
            catch
            {
                GC.SuppressFinalize(handle);
                if (target.IsAllocated) target.Free();
                throw;
            }
            LogTarget.ThrowOn(log);
        }

        /// <summary>A world of a batch.</summary>
        internal Solver(IntPtr world, BatchHandle batch, LogTarget log, uint dimension, uint precision)
        {
            handle = new SolverHandle(world, batch);
            this.log = log;
            this.dimension = dimension;
            this.precision = precision;
        }

        /// <summary>Of a world of a batch: steps that have begun end, and the world stays.</summary>
        public void Dispose()
        {
            if (handle.IsWorld && !handle.IsClosed)
            {
                Native.pbf_cancel(handle);
                Native.pbf_end_step(handle);
            }
            handle.Dispose();
        }

        // ---- Steps

        public void Step(uint steps = 1) { Check(Native.pbf_step(handle, steps)); }

        /// <summary>
        /// Runs them in a thread of the solver's, until EndStep; other calls are refused meanwhile, but for Cancel
        /// and TakeSnapshot.
        /// </summary>
        public void BeginStep(uint steps = 1) { PbfException.Check(Native.pbf_begin_step(handle, steps)); }

        public void EndStep() { Check(Native.pbf_end_step(handle)); }
        public void Cancel() { PbfException.Check(Native.pbf_cancel(handle)); }
        public void Synchronize() { Check(Native.pbf_synchronize(handle)); }

        // ---- Parameters and colliders

        public Params Parameters
        {
            get
            {
                var got = new Params { StructSize = Params.Size };
                Check(Native.pbf_get_params(handle, ref got));
                return got;
            }
            set
            {
                value.StructSize = Params.Size;
                using (var pins = new Pins()) Check(Native.pbf_set_params(handle, pins.Of(value)));
            }
        }

        public void SetColliders(params Collider[] colliders)
        {
            var raw = Arrays.Colliders(colliders, "colliders");
            using (var pins = new Pins()) Check(Native.pbf_set_colliders(handle, (uint)raw.Length, pins.Of(raw)));
            GC.KeepAlive(colliders); // and so their shapes
        }

        /// <summary>To these poses and sizes, in this time from now.</summary>
        public void MoveColliders(Collider[] targets, double duration)
        {
            var raw = Arrays.Colliders(targets, "targets");
            using (var pins = new Pins()) Check(Native.pbf_move_colliders(handle, (uint)raw.Length, pins.Of(raw), duration));
            GC.KeepAlive(targets);
        }

        public Collider[] GetColliders()
        {
            uint count = 0;
            Check(Native.pbf_get_collider_count(handle, ref count));
            var colliders = new Collider[count];
            for (uint i = 0; i < count; ++i)
            {
                var raw = new NativeCollider { StructSize = Arrays.SizeOf<NativeCollider>() };
                Check(Native.pbf_get_collider(handle, i, ref raw));
                colliders[i] = new Collider(raw);
            }
            return colliders;
        }

        /// <summary>What the fluid does to each collider; begins their sums anew. Wants Params.Loads.</summary>
        public ColliderLoad[] GetColliderLoads()
        {
            uint count = 0;
            Check(Native.pbf_get_collider_count(handle, ref count));
            return Loads(count, Native.pbf_get_collider_loads);
        }

        /// <summary>The same of the domain's walls, by Constants.WallXMin and so on.</summary>
        public ColliderLoad[] GetWallLoads() { return Loads(2 * dimension, Native.pbf_get_wall_loads); }

        // ---- Particles

        public uint Count
        {
            get
            {
                uint count = 0;
                Check(Native.pbf_get_count(handle, ref count));
                return count;
            }
        }

        /// <summary>Gives the id of the first one. Without velocities they are at rest.</summary>
        public uint AddParticles(float[] positions, float[] velocities = null) { return Add(positions, velocities); }
        public uint AddParticles(double[] positions, double[] velocities = null) { return Add(positions, velocities); }

        public void RemoveParticles(uint[] ids)
        {
            Arrays.Given(ids, "ids");
            using (var pins = new Pins()) Check(Native.pbf_remove_particles(handle, (uint)ids.Length, pins.Of(ids)));
        }

        /// <summary>Gives how many they were.</summary>
        public uint RemoveInBox(Vector3d lower, Vector3d upper)
        {
            uint count = 0;
            using (var pins = new Pins())
                Check(Native.pbf_remove_in_box(handle, pins.Of(lower), pins.Of(upper), ref count));
            return count;
        }

        public uint[] FindInBox(Vector3d lower, Vector3d upper)
        {
            var ids = new uint[Count];
            uint count = 0;
            using (var pins = new Pins())
                Check(Native.pbf_find_in_box(handle, pins.Of(lower), pins.Of(upper), (uint)ids.Length, pins.Of(ids), ref count));
            Array.Resize(ref ids, (int)count);
            return ids;
        }

        /// <summary>As many particles as the array has room for, from row `first` on.</summary>
        public void GetPositions(float[] into, uint first = 0) { Rows(Native.pbf_get_positions, into, first, dimension); }
        public void GetPositions(double[] into, uint first = 0) { Rows(Native.pbf_get_positions, into, first, dimension); }
        public void GetVelocities(float[] into, uint first = 0) { Rows(Native.pbf_get_velocities, into, first, dimension); }
        public void GetVelocities(double[] into, uint first = 0) { Rows(Native.pbf_get_velocities, into, first, dimension); }
        public void GetDensities(float[] into, uint first = 0) { Rows(Native.pbf_get_densities, into, first, 1); }
        public void GetDensities(double[] into, uint first = 0) { Rows(Native.pbf_get_densities, into, first, 1); }
        public void GetPressures(float[] into, uint first = 0) { Rows(Native.pbf_get_pressures, into, first, 1); }
        public void GetPressures(double[] into, uint first = 0) { Rows(Native.pbf_get_pressures, into, first, 1); }
        public void SetPositions(float[] from, uint first = 0) { Rows(Native.pbf_set_positions, from, first, dimension); }
        public void SetPositions(double[] from, uint first = 0) { Rows(Native.pbf_set_positions, from, first, dimension); }
        public void SetVelocities(float[] from, uint first = 0) { Rows(Native.pbf_set_velocities, from, first, dimension); }
        public void SetVelocities(double[] from, uint first = 0) { Rows(Native.pbf_set_velocities, from, first, dimension); }

        /// <summary>Beside gravity, in each step until they are set anew.</summary>
        public void SetAccelerations(float[] from, uint first = 0) { Rows(Native.pbf_set_accelerations, from, first, dimension); }
        public void SetAccelerations(double[] from, uint first = 0) { Rows(Native.pbf_set_accelerations, from, first, dimension); }

        /// <summary>Takes all of them away, and their memory.</summary>
        public void ClearAccelerations() { Check(Native.pbf_set_accelerations(handle, 0, 0, IntPtr.Zero)); }

        public uint[] GetIds()
        {
            var ids = new uint[Count];
            using (var pins = new Pins()) Check(Native.pbf_get_ids(handle, 0, (uint)ids.Length, pins.Of(ids)));
            return ids;
        }

        /// <summary>A field, Constants.FieldPosition and so on, without a copy.</summary>
        public View Map(uint field) { return new View(handle, field); }

        // ---- Snapshots, state, reports

        /// <summary>Keeps room for so many snapshots; from then on each step ends with one. 0: none.</summary>
        public void SetSnapshots(uint snapshots) { Check(Native.pbf_set_snapshots(handle, snapshots)); }

        public Snapshot TakeSnapshot() { return new Snapshot(handle); }

        public byte[] Save()
        {
            ulong size = 0;
            Check(Native.pbf_save(handle, IntPtr.Zero, ref size));
            var state = new byte[size];
            using (var pins = new Pins()) Check(Native.pbf_save(handle, pins.Of(state), ref size));
            return state;
        }

        public void Load(byte[] state)
        {
            Arrays.Given(state, "state");
            using (var pins = new Pins()) Check(Native.pbf_load(handle, pins.Of(state), (ulong)state.Length));
        }

        public ulong Hash()
        {
            ulong hash = 0;
            Check(Native.pbf_hash(handle, ref hash));
            return hash;
        }

        public Stats GetStats()
        {
            var got = new Stats { StructSize = Arrays.SizeOf<Stats>() };
            Check(Native.pbf_get_stats(handle, ref got));
            return got;
        }

        public Info GetInfo()
        {
            var got = new Info { StructSize = Arrays.SizeOf<Info>() };
            Check(Native.pbf_get_info(handle, ref got));
            return got;
        }

        /// <summary>StageCount and ArrayCount say how many of its entries hold.</summary>
        public Plan GetPlan()
        {
            var got = new Plan
            {
                StructSize = Arrays.SizeOf<Plan>(),
                Stages = new PlanStage[Constants.MaxStages],
                Arrays = new PlanArray[Constants.MaxArrays]
            };
            Check(Native.pbf_get_plan(handle, ref got));
            return got;
        }

        public void SetTiming(bool enabled) { Check(Native.pbf_set_timing(handle, enabled ? 1u : 0u)); }

        public Timings GetTimings()
        {
            var got = new Timings { StructSize = Arrays.SizeOf<Timings>(), Stages = new StageTime[Constants.MaxStages] };
            Check(Native.pbf_get_timings(handle, ref got));
            return got;
        }

        /// <summary>The longest time step that the present state stands.</summary>
        public double GetStepLimit()
        {
            double limit = 0;
            Check(Native.pbf_get_step_limit(handle, ref limit));
            return limit;
        }

        /// <summary>Of the library at run time.</summary>
        public static Version LibraryVersion
        {
            get
            {
                int number = (int)Native.pbf_version();
                return new Version(number / 1000000, number / 1000 % 1000, number % 1000);
            }
        }

        /// <summary>Loads a plugin from an absolute path, for the life of the process: the code in it is run.</summary>
        public static void LoadBackend(string path)
        {
            PbfException.Check(Text.With("path", path, at => Native.pbf_load_backend(at)));
        }

        /// <summary>Every backend found, judged for a solver like desc, and every file that failed to load.</summary>
        public static BackendInfo[] Backends(Desc desc = null)
        {
            return (desc ?? new Desc()).With(raw =>
            {
                uint count = 0;
                PbfException.Check(Native.pbf_get_backend_count(ref count));
                var found = new BackendInfo[count];
                using (var pins = new Pins())
                {
                    var wanted = pins.Of(raw);
                    for (uint i = 0; i < count; ++i)
                    {
                        found[i].StructSize = Arrays.SizeOf<BackendInfo>();
                        PbfException.Check(Native.pbf_get_backend_info(wanted, i, ref found[i]));
                    }
                }
                return found;
            });
        }

        // ---- What the calls have in common

        private delegate Status LoadsCall(SolverHandle solver, uint count, IntPtr loads);
        private delegate Status RowsCall(SolverHandle solver, uint first, uint count, IntPtr rows);

        private uint ParticlesOf(Array array, uint components)
        {
            Arrays.OfPrecision(Arrays.Given(array, "the array"), precision);
            return Arrays.Rows("the array", array, components);
        }

        private uint Add(Array positions, Array velocities)
        {
            uint count = ParticlesOf(positions, dimension), first = 0;
            if (velocities != null && velocities.Length != positions.Length)
                throw PbfException.Invalid($"velocities has {velocities.Length} numbers, positions {positions.Length}");
            using (var pins = new Pins())
                Check(Native.pbf_add_particles(handle, count, pins.Of(positions), pins.Of(velocities), ref first));
            return first;
        }

        private ColliderLoad[] Loads(uint count, LoadsCall call)
        {
            var loads = new ColliderLoad[count];
            for (uint i = 0; i < count; ++i) loads[i].StructSize = Arrays.SizeOf<ColliderLoad>();
            using (var pins = new Pins()) Check(call(handle, count, pins.Of(loads)));
            return loads;
        }

        private void Rows(RowsCall call, Array array, uint first, uint components)
        {
            uint count = ParticlesOf(array, components);
            using (var pins = new Pins()) Check(call(handle, first, count, pins.Of(array)));
        }

        private void Check(Status status)
        {
            if (status != Status.Busy) LogTarget.ThrowOn(log); // steps that have begun tell at their end
            PbfException.Check(status);
        }
    }
}
