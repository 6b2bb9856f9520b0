using System;

namespace Pbf
{
    public partial struct Volume
    {
        public static Volume Box(Vector3d center, Vector3d halfExtents)
        {
            var made = Of(Constants.VolumeBox, center);
            made.HalfExtents = halfExtents;
            return made;
        }

        public static Volume Sphere(Vector3d center, double radius)
        {
            var made = Of(Constants.VolumeSphere, center);
            made.Radius = radius;
            return made;
        }

        /// <summary>From its middle halfLength along the axis to either end.</summary>
        public static Volume Capsule(Vector3d center, Vector3d axis, double halfLength, double radius)
        {
            var made = Of(Constants.VolumeCapsule, center);
            made.Axis = axis;
            made.HalfLength = halfLength;
            made.Radius = radius;
            return made;
        }

        private static Volume Of(uint shape, Vector3d center)
        {
            var made = new Volume();
            PbfException.Check(Native.pbf_volume_init(ref made, Arrays.SizeOf<Volume>(), shape));
            made.Position = center;
            return made;
        }
    }

    // Questions by place, in double whatever the precision. Arrays of points have Desc.Dimension numbers each.
    public sealed partial class Solver
    {
        /// <summary>The ids of the particles there, ascending.</summary>
        public uint[] FindIn(Volume volume)
        {
            var ids = new uint[Count];
            uint count = 0;
            volume.StructSize = Arrays.SizeOf<Volume>();
            using (var pins = new Pins())
                Check(Native.pbf_find_in_volume(handle, pins.Of(volume), (uint)ids.Length, pins.Of(ids), ref count));
            Array.Resize(ref ids, (int)count);
            return ids;
        }

        /// <summary>How much of each volume is below the surface, and how that flows.</summary>
        public VolumeFlow[] Measure(params Volume[] volumes)
        {
            var sized = (Volume[])Arrays.Given(volumes, "volumes").Clone();
            var flows = new VolumeFlow[sized.Length];
            for (int i = 0; i < sized.Length; ++i)
            {
                sized[i].StructSize = Arrays.SizeOf<Volume>();
                flows[i].StructSize = Arrays.SizeOf<VolumeFlow>();
            }
            using (var pins = new Pins())
                Check(Native.pbf_measure_volumes(handle, (uint)sized.Length, pins.Of(sized), pins.Of(flows)));
            return flows;
        }

        /// <summary>
        /// Into arrays with a number a point, velocities Desc.Dimension of them; null: that is not asked for. Densities
        /// are over that at rest; wet is 1 where there is water, or 0.
        /// </summary>
        public void Sample(double[] points, double[] densities = null, double[] velocities = null, double[] pressures = null, byte[] wet = null)
        {
            long count = Arrays.Rows("points", points, dimension);
            using (var pins = new Pins())
            {
                var samples = Samples(pins, count, densities, velocities, pressures, wet);
                samples.Points = pins.Of(points);
                Check(Native.pbf_sample(handle, pins.Of(samples)));
            }
        }

        /// <summary>The same at the points origin + (i, j, k) step; in arrays the last index is the fastest.</summary>
        public void SampleOnGrid(Vector3u counts, Vector3d origin, Vector3d step, double[] densities = null, double[] velocities = null,
            double[] pressures = null, byte[] wet = null)
        {
            double count = (double)counts.X * counts.Y * (dimension == 3 ? counts.Z : 1);
            if (count > int.MaxValue) throw PbfException.Invalid($"counts is {counts}, more points than an array has elements");
            var grid = new NativeSampleGrid { StructSize = Arrays.SizeOf<NativeSampleGrid>(), Counts = counts, Origin = origin, Step = step };
            using (var pins = new Pins())
            {
                var samples = Samples(pins, (long)count, densities, velocities, pressures, wet);
                Check(Native.pbf_sample_on_grid(handle, pins.Of(grid), pins.Of(samples)));
            }
        }

        private NativeSamples Samples(Pins pins, long count, double[] densities, double[] velocities, double[] pressures, byte[] wet)
        {
            Arrays.HasLength("densities", densities, count);
            Arrays.HasLength("velocities", velocities, count * dimension);
            Arrays.HasLength("pressures", pressures, count);
            Arrays.HasLength("wet", wet, count);
            return new NativeSamples
            {
                StructSize = Arrays.SizeOf<NativeSamples>(), Count = (uint)count, Densities = pins.Of(densities),
                Velocities = pins.Of(velocities), Pressures = pins.Of(pressures), Wet = pins.Of(wet)
            };
        }

        /// <summary>
        /// How far rays are from the surface, infinite where they do not meet it within `length`, and its normals there: as
        /// many rays as `distances` has numbers.
        /// </summary>
        public void CastRays(double[] origins, double[] directions, double length, double[] distances, double[] normals = null)
        {
            long numbers = (long)Arrays.Given(distances, "distances").Length * dimension;
            Arrays.HasLength("origins", Arrays.Given(origins, "origins"), numbers);
            Arrays.HasLength("directions", Arrays.Given(directions, "directions"), numbers);
            Arrays.HasLength("normals", normals, numbers);
            using (var pins = new Pins())
                Check(Native.pbf_cast_rays(handle, (uint)distances.Length, pins.Of(origins), pins.Of(directions), length,
                    pins.Of(distances), pins.Of(normals)));
        }

        /// <summary>How high the water stands at points, against gravity; NaN where there is none.</summary>
        public double[] GetLevels(double[] points)
        {
            var levels = new double[Arrays.Rows("points", points, dimension)];
            using (var pins = new Pins())
                Check(Native.pbf_get_levels(handle, (uint)levels.Length, pins.Of(points), pins.Of(levels)));
            return levels;
        }

        /// <summary>Gives back the memory that queries keep.</summary>
        public void EndQueries() { Check(Native.pbf_end_queries(handle)); }
    }
}
