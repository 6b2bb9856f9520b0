using System;
using System.Runtime.InteropServices;

namespace Pbf
{
    /// <summary>
    /// A solid of any form, which colliders of Collider.Solid have: made once, never changed, in memory once. It lives
    /// while one of its objects, a collider or a solver has it, and may be used in any threads.
    /// </summary>
    public sealed class Shape : IDisposable
    {
        private readonly ShapeHandle handle;

        private Shape(ShapeHandle handle) { this.handle = handle; }

        /// <summary>
        /// Signed distances, negative inside, at origin + cell (i, j, k), the first index the fastest: in 2D nodes and
        /// origin have two numbers.
        /// </summary>
        public static Shape FromGrid(uint[] nodes, double[] origin, double cell, float[] values)
        {
            uint dimension = Dimension("nodes", Arrays.Given(nodes, "nodes").Length);
            Arrays.HasLength("origin", Arrays.Given(origin, "origin"), dimension);
            Arrays.HasLength("values", Arrays.Given(values, "values"), Product(nodes));
            var desc = new NativeGridDesc
            {
                StructSize = Arrays.SizeOf<NativeGridDesc>(), Dimension = dimension, Cell = cell,
                Nodes = new Vector3u(nodes[0], nodes[1], dimension == 3 ? nodes[2] : 0),
                Origin = new Vector3d(origin[0], origin[1], dimension == 3 ? origin[2] : 0)
            };
            using (var pins = new Pins())
            {
                desc.Values = pins.Of(values);
                PbfException.Check(Native.pbf_shape_from_grid(pins.Of(desc), out IntPtr made));
                return Owned(made);
            }
        }

        /// <summary>
        /// What a closed surface of triangles encloses, in 2D a closed line of segments: coordinates of vertices and
        /// numbers of faces, `dimension` of them each. With a thickness a shell along a surface, open or not.
        /// </summary>
        public static Shape FromMesh(uint dimension, double[] vertices, uint[] faces, double cell, double thickness = 0)
        {
            var desc = new NativeMeshDesc
            {
                StructSize = Arrays.SizeOf<NativeMeshDesc>(), Dimension = Dimension("dimension", dimension), Cell = cell, Thickness = thickness,
                VertexCount = Arrays.Rows("vertices", vertices, dimension), FaceCount = Arrays.Rows("faces", faces, dimension)
            };
            using (var pins = new Pins())
            {
                desc.Vertices = pins.Of(vertices);
                desc.Faces = pins.Of(faces);
                PbfException.Check(Native.pbf_shape_from_mesh(pins.Of(desc), out IntPtr made));
                return Owned(made);
            }
        }

        /// <summary>
        /// A terrain down to `bottom`: heights[j counts[0] + i] is the y above (i, j) spacing, along x and z; in 2D
        /// counts has one number.
        /// </summary>
        public static Shape FromHeights(uint[] counts, double[] heights, double spacing, double bottom, double cell)
        {
            uint dimension = Dimension("counts", Arrays.Given(counts, "counts").Length + 1);
            Arrays.HasLength("heights", Arrays.Given(heights, "heights"), Product(counts));
            var desc = new NativeHeightsDesc
            {
                StructSize = Arrays.SizeOf<NativeHeightsDesc>(), Dimension = dimension, Spacing = spacing, Base = bottom, Cell = cell,
                Count = new Vector2u(counts[0], dimension == 3 ? counts[1] : 0)
            };
            using (var pins = new Pins())
            {
                desc.Heights = pins.Of(heights);
                PbfException.Check(Native.pbf_shape_from_heights(pins.Of(desc), out IntPtr made));
                return Owned(made);
            }
        }

        /// <summary>The convex hull of points, `dimension` coordinates each.</summary>
        public static Shape FromPoints(uint dimension, double[] points, double cell)
        {
            var desc = new NativeHullDesc
            {
                StructSize = Arrays.SizeOf<NativeHullDesc>(), Dimension = Dimension("dimension", dimension), Cell = cell,
                PointCount = Arrays.Rows("points", points, dimension)
            };
            using (var pins = new Pins())
            {
                desc.Points = pins.Of(points);
                PbfException.Check(Native.pbf_shape_from_points(pins.Of(desc), out IntPtr made));
                return Owned(made);
            }
        }

        /// <summary>Gives this object's reference back; solvers that have the shape keep it.</summary>
        public void Dispose() { handle.Dispose(); }

        public ShapeInfo GetInfo()
        {
            var info = new ShapeInfo { StructSize = Arrays.SizeOf<ShapeInfo>() };
            PbfException.Check(Native.pbf_get_shape_info(handle, ref info));
            return info;
        }

        /// <summary>Of a point in the shape's own space, and the direction in which it grows.</summary>
        public double GetDistance(Vector3d point, out Vector3d normal)
        {
            double distance = 0;
            var towards = new double[3];
            using (var pins = new Pins())
                PbfException.Check(Native.pbf_get_shape_distance(handle, pins.Of(point), ref distance, pins.Of(towards)));
            normal = new Vector3d(towards[0], towards[1], towards[2]);
            return distance;
        }

        /// <summary>The distances at its nodes, as FromGrid takes them.</summary>
        public float[] GetValues()
        {
            ShapeInfo info = GetInfo();
            var values = new float[(long)info.Nodes.X * info.Nodes.Y * (info.Dimension == 3 ? info.Nodes.Z : 1)];
            using (var pins = new Pins())
                PbfException.Check(Native.pbf_get_shape_values(handle, (ulong)values.Length, pins.Of(values)));
            return values;
        }

        /// <summary>As bytes, for a file.</summary>
        public byte[] Save()
        {
            ulong size = 0;
            PbfException.Check(Native.pbf_save_shape(handle, IntPtr.Zero, ref size));
            var saved = new byte[size];
            using (var pins = new Pins()) PbfException.Check(Native.pbf_save_shape(handle, pins.Of(saved), ref size));
            return saved;
        }

        /// <summary>Of what Save or pbf-bake wrote.</summary>
        public static Shape Load(byte[] saved)
        {
            Arrays.Given(saved, "saved");
            using (var pins = new Pins())
            {
                PbfException.Check(Native.pbf_load_shape(pins.Of(saved), (ulong)saved.Length, out IntPtr made));
                return Owned(made);
            }
        }

        public double GetDistance(Vector3d point) { return GetDistance(point, out _); }

        /// <summary>One more reference to the shape of a solver's collider.</summary>
        internal static Shape At(IntPtr shape)
        {
            if (shape == IntPtr.Zero) return null;
            PbfException.Check(Native.pbf_hold_shape(shape));
            return Owned(shape);
        }

        internal static IntPtr AddressOf(Shape shape)
        {
            if (shape == null) return IntPtr.Zero;
            if (shape.handle.IsClosed) throw new ObjectDisposedException(nameof(Shape));
            return shape.handle.DangerousGetHandle();
        }

        private static Shape Owned(IntPtr shape) { return new Shape(new ShapeHandle(shape)); }

        private static uint Dimension(string name, long dimension)
        {
            if (dimension != 2 && dimension != 3) throw PbfException.Invalid($"{name} is of {dimension} dimensions; there are 2 and 3");
            return (uint)dimension;
        }

        private static long Product(uint[] counts)
        {
            double product = 1; // which does not overflow, and is exact where an array can be as long
            foreach (uint count in counts) product *= count;
            return product < long.MaxValue ? (long)product : long.MaxValue;
        }
    }

    internal sealed class ShapeHandle : SafeHandle
    {
        internal ShapeHandle(IntPtr shape) : base(IntPtr.Zero, true) { SetHandle(shape); }

        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }

        protected override bool ReleaseHandle()
        {
            Native.pbf_release_shape(handle);
            return true;
        }
    }
}
