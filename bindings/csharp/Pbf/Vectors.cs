using System;
using System.Runtime.InteropServices;

namespace Pbf
{
    [StructLayout(LayoutKind.Sequential)]
    public struct Vector3d
    {
        public double X, Y, Z;

        public Vector3d(double x, double y, double z)
        {
            X = x;
            Y = y;
            Z = z;
        }

        public override string ToString() { return $"({X}, {Y}, {Z})"; }
    }

    /// <summary>A quaternion.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Vector4d
    {
        public double X, Y, Z, W;

        public Vector4d(double x, double y, double z, double w)
        {
            X = x;
            Y = y;
            Z = z;
            W = w;
        }
    }

    /// <summary>How many along each axis.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Vector3u
    {
        public uint X, Y, Z;

        public Vector3u(uint x, uint y, uint z)
        {
            X = x;
            Y = y;
            Z = z;
        }

        public override string ToString() { return $"({X}, {Y}, {Z})"; }
    }

    [StructLayout(LayoutKind.Sequential)]
    internal struct Vector2u
    {
        public uint X, Y;

        public Vector2u(uint x, uint y)
        {
            X = x;
            Y = y;
        }
    }

    /// <summary>A number for each of the six walls: 2 * axis for the lower one, + 1 for the upper.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Walls
    {
        public double XMin, XMax, YMin, YMax, ZMin, ZMax;
    }
}
