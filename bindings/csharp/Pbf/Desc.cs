using System;
using System.Runtime.InteropServices;

namespace Pbf
{
    /// <summary>What cannot change in a solver's life; the defaults are those of pbf_desc_init.</summary>
    public sealed class Desc
    {
        public uint Dimension;
        /// <summary>Constants.Float32 or Constants.Float64: what arrays hold.</summary>
        public uint Precision;
        public uint Capacity;
        /// <summary>The backend or failure; else another one may serve, see Info.FellBack.</summary>
        public bool Strict;
        public string Backend = "auto";
        public int Device;
        public uint Threads;
        public string Isa;
        /// <summary>Constants.DeterminismAcrossMachines or Constants.DeterminismPerMachine.</summary>
        public uint Determinism;
        /// <summary>A cudaStream_t, or zero.</summary>
        public IntPtr Stream;
        /// <summary>
        /// Level and sentence, from whichever thread is in the library. What it throws is thrown on by the
        /// call that it was called in, when that has returned.
        /// </summary>
        public Action<uint, string> Log;

        public Desc()
        {
            var raw = Defaults();
            Dimension = raw.Dimension;
            Precision = raw.Precision;
            Capacity = raw.Capacity;
            Device = raw.Device;
            Threads = raw.Threads;
        }

        internal static NativeDesc Defaults()
        {
            var raw = new NativeDesc();
            PbfException.Check(Native.pbf_desc_init(ref raw, (uint)Marshal.SizeOf(typeof(NativeDesc))));
            return raw;
        }

        internal delegate Status Maker(IntPtr desc, IntPtr parameters, out IntPtr made);

        /// <summary>A solver or a batch, which calls the log target.</summary>
        internal IntPtr Create(Params? parameters, GCHandle target, Maker make)
        {
            var first = parameters ?? Params.Default;
            first.StructSize = Params.Size;
            return With(raw =>
            {
                if (target.IsAllocated)
                {
                    raw.Log = Marshal.GetFunctionPointerForDelegate(LogTarget.Write);
                    raw.LogUser = GCHandle.ToIntPtr(target);
                }
                using (var pins = new Pins())
                {
                    PbfException.Check(make(pins.Of(raw), pins.Of(first), out IntPtr made));
                    return made;
                }
            });
        }

        internal T With<T>(Func<NativeDesc, T> call)
        {
            var raw = Defaults();
            raw.Dimension = Dimension;
            raw.Precision = Precision;
            raw.Capacity = Capacity;
            raw.Strict = Strict ? 1u : 0u;
            raw.Device = Device;
            raw.Threads = Threads;
            raw.Determinism = Determinism;
            raw.Stream = Stream;
            return Text.With("Desc.Backend", Backend, backend => Text.With("Desc.Isa", Isa, isa =>
            {
                raw.Backend = backend;
                raw.Isa = isa;
                return call(raw);
            }));
        }
    }

    public partial struct Params
    {
        /// <summary>Those of pbf_params_init: water, particles 0.05 apart, a box of side 1.</summary>
        public static Params Default
        {
            get
            {
                var made = new Params();
                PbfException.Check(Native.pbf_params_init(ref made, Size));
                return made;
            }
        }

        internal static uint Size { get { return (uint)Marshal.SizeOf(typeof(Params)); } }
    }

    public partial struct Collider
    {
        /// <summary>At rest at the origin, sizes 1; the shape is one of Constants.Collider…</summary>
        public static Collider Of(uint shape)
        {
            var made = new NativeCollider();
            PbfException.Check(Native.pbf_collider_init(ref made, Arrays.SizeOf<NativeCollider>(), shape));
            return new Collider(made);
        }

        /// <summary>As large as the shape is, whose own 0 is at the position; Scale makes it larger.</summary>
        public static Collider Solid(Shape shape, Vector3d position)
        {
            var made = Of(Constants.ColliderShape);
            made.Geometry = Arrays.Given(shape, "shape");
            made.Position = position;
            return made;
        }

        public static Collider Sphere(Vector3d center, double radius)
        {
            var made = Of(Constants.ColliderSphere);
            made.Position = center;
            made.Radius = radius;
            return made;
        }

        public static Collider Box(Vector3d center, Vector3d halfExtents)
        {
            var made = Of(Constants.ColliderBox);
            made.Position = center;
            made.HalfExtents = halfExtents;
            return made;
        }

        /// <summary>From its middle halfLength along the axis to either end.</summary>
        public static Collider Capsule(Vector3d center, Vector3d axis, double halfLength, double radius)
        {
            var made = Of(Constants.ColliderCapsule);
            made.Position = center;
            made.Axis = axis;
            made.HalfLength = halfLength;
            made.Radius = radius;
            return made;
        }

        /// <summary>Through a point; the fluid is on the side of the normal.</summary>
        public static Collider Plane(Vector3d point, Vector3d normal)
        {
            var made = Of(Constants.ColliderPlane);
            made.Position = point;
            made.Axis = normal;
            return made;
        }
    }
}
