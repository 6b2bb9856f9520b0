// Written by tools/bindings.py from bindings/abi.json; do not edit.
#pragma warning disable 1591
using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;

namespace Pbf
{
    public enum Status
    {
        Ok = 0,
        InvalidArgument = -1,
        StructSize = -2,
        OutOfMemory = -3,
        Capacity = -4,
        NotFound = -5,
        Unavailable = -6,
        Unsupported = -7,
        Busy = -8,
        State = -9,
        Device = -10,
        Plugin = -11,
        Data = -12,
        Cancelled = -13
    }

    /// <summary>What the C headers call PBF_….</summary>
    public static class Constants
    {
        public const uint VersionMajor = 0;
        public const uint VersionMinor = 2;
        public const uint VersionPatch = 0;
        public const uint ApiVersion = 2;
        public const uint NameSize = 32;
        public const uint MaxCapacity = 1073741823;
        public const uint MaxColliders = 4096;
        public const uint MaxSnapshots = 16;
        public const uint MaxStages = 24;
        public const uint MaxArrays = 40;
        public const uint MaxWorlds = 65536;
        public const uint MaxDiffuse = 4194303;
        public const uint MaxEmitters = 64;
        public const uint MaxDrains = 64;
        public const uint MaxReservoirs = 64;
        public const uint MaxPhases = 8;
        public const uint DeviceCpu = 1;
        public const uint DeviceCuda = 2;
        public const uint TypeFloat32 = 4;
        public const uint TypeFloat64 = 8;
        public const uint TypeUint32 = 12;
        public const uint FieldPosition = 1;
        public const uint FieldVelocity = 2;
        public const uint FieldId = 3;
        public const uint FieldDensity = 4;
        public const uint FieldPressure = 5;
        public const uint Float32 = 4;
        public const uint Float64 = 8;
        public const uint DeterminismAcrossMachines = 0;
        public const uint DeterminismPerMachine = 1;
        public const uint LogInfo = 1;
        public const uint LogWarning = 2;
        public const uint KernelWendlandC2 = 0;
        public const uint KernelPoly6Spiky = 1;
        public const uint SolverJacobi = 0;
        public const uint SolverChebyshev = 1;
        public const uint CollideAfterPrediction = 1;
        public const uint CollideInIteration = 2;
        public const uint CollideAfterSolve = 4;
        public const uint PeriodicX = 1;
        public const uint PeriodicY = 2;
        public const uint PeriodicZ = 4;
        public const uint WallXMin = 0;
        public const uint WallXMax = 1;
        public const uint WallYMin = 2;
        public const uint WallYMax = 3;
        public const uint WallZMin = 4;
        public const uint WallZMax = 5;
        public const uint ColliderPlane = 0;
        public const uint ColliderSphere = 1;
        public const uint ColliderCapsule = 2;
        public const uint ColliderBox = 3;
        public const uint ColliderShape = 4;
        public const uint PathAuto = 0;
        public const uint PathStraight = 1;
        public const uint PathScrew = 2;
        public const uint WConstant = 0;
        public const uint WSpeed = 1;
        public const uint WDensity = 2;
        public const uint WPressure = 3;
        public const uint OrderAdded = 0;
        public const uint OrderStored = 1;
        public const uint LimitNone = 0;
        public const uint LimitGravity = 1;
        public const uint LimitAttraction = 2;
        public const uint LimitParticles = 3;
        public const uint LimitWalls = 4;
        public const uint LimitColliders = 5;
        public const uint LimitTension = 6;
        public const uint DiffuseSpray = 0;
        public const uint DiffuseFoam = 1;
        public const uint DiffuseBubble = 2;
        public const uint VolumeBox = 0;
        public const uint VolumeSphere = 1;
        public const uint VolumeCapsule = 2;
        public const uint EmitterRectangle = 0;
        public const uint EmitterDisc = 1;
    }

    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
    internal delegate void LogFn(IntPtr argument0, int argument1, IntPtr argument2);

    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
    internal delegate void TaskFn(IntPtr argument0, uint argument1, uint argument2);

    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
    internal delegate IntPtr EnqueueTaskFn(IntPtr argument0, IntPtr argument1, IntPtr argument2, uint argument3, uint argument4);

    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
    internal delegate void FinishTaskFn(IntPtr argument0, IntPtr argument1);

    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
    internal delegate IntPtr AllocatorAllocateFn(IntPtr argument0, ulong argument1, ulong argument2);

    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
    internal delegate void AllocatorReleaseFn(IntPtr argument0, IntPtr argument1, ulong argument2, ulong argument3);

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    internal partial struct NativeAllocator
    {
        public uint StructSize;
        public uint Reserved;
        public IntPtr User;
        public IntPtr Allocate;
        public IntPtr Release;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    internal partial struct NativeDesc
    {
        public uint StructSize;
        public uint ApiVersion;
        public uint Dimension;
        public uint Precision;
        public uint Capacity;
        public uint Strict;
        public IntPtr Backend;
        public int Device;
        public uint Threads;
        public IntPtr Stream;
        public IntPtr Allocator;
        public IntPtr Log;
        public IntPtr LogUser;
        public IntPtr Isa;
        public IntPtr EnqueueTask;
        public IntPtr FinishTask;
        public IntPtr TaskUser;
        public uint Determinism;
        public uint Reserved;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct Params
    {
        public uint StructSize;
        public uint Kernel;
        public double SmoothingRadius;
        public double Spacing;
        public double ParticleVolume;
        public double TimeStep;
        public uint Iterations;
        public uint Collide;
        public Vector3d Gravity;
        public double Attraction;
        public Vector3d AttractionCenter;
        public double OverRelaxation;
        public double Cfm;
        public double Cohesion;
        public double MinDiagonal;
        public double WallDensity;
        public double ScorrK;
        public double ScorrDq;
        public uint ScorrN;
        public uint Solver;
        public double Vorticity;
        public double Viscosity;
        public Vector3d DomainMin;
        public Vector3d DomainMax;
        public Walls WallVelocity;
        public Walls WallAmplitude;
        public Walls WallFrequency;
        public Walls WallPhase;
        public double SearchCellWidth;
        public double SleepSpeed;
        public double SleepTime;
        public double Tolerance;
        public double PressureGrid;
        public double Prestabilization;
        public double DampingCompensation;
        public double AngularMomentumCorrection;
        public double Drag;
        public Vector3d DragVelocity;
        public double MaxDepenetrationSpeed;
        public uint MaxSubsteps;
        public uint Loads;
        public double ShearStressCorrection;
        public double WallFriction;
        public double WallStaticFriction;
        public double WallNoSlip;
        public double SurfaceTension;
        public uint Periodic;
        public uint Reserved;
        public double WallAdhesion;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    internal partial struct NativeCollider
    {
        public uint StructSize;
        public uint Shape;
        public uint Inverted;
        public uint Path;
        public Vector3d Position;
        public Vector4d Orientation;
        public Vector3d Velocity;
        public Vector3d AngularVelocity;
        public Vector3d Axis;
        public Vector3d HalfExtents;
        public double Radius;
        public double HalfLength;
        public Vector3d HalfExtentsRate;
        public double RadiusRate;
        public double HalfLengthRate;
        public double Duration;
        public IntPtr Geometry;
        public double Scale;
        public double ScaleRate;
        public double Friction;
        public double StaticFriction;
        public double NoSlip;
        public double Adhesion;
        public Vector3d LastVelocity;
        public Vector3d LastAngularVelocity;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct ColliderLoad
    {
        public uint StructSize;
        public uint Contacts;
        public Vector3d Impulse;
        public Vector3d AngularImpulse;
        public Vector3d ImpulseSum;
        public Vector3d AngularImpulseSum;
        public double TimeSum;
        public double Penetration;
        public double WettedArea;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    internal partial struct NativeReadDesc
    {
        public uint StructSize;
        public uint Field;
        public uint First;
        public uint Count;
        public uint ElementType;
        public uint Components;
        public uint W;
        public uint Order;
        public ulong Stride;
        public IntPtr Data;
        public double Behind;
        public double WValue;
        public uint DeviceType;
        public uint Reserved;
        public IntPtr Stream;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct WriteDesc
    {
        public uint StructSize;
        public uint Field;
        public uint First;
        public uint Count;
        public uint ElementType;
        public uint Components;
        public ulong Stride;
        public IntPtr Data;
        public uint DeviceType;
        public uint Reserved;
        public IntPtr Stream;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    internal partial struct NativeView
    {
        public uint StructSize;
        public uint Field;
        public uint DeviceType;
        public int DeviceId;
        public uint ElementType;
        public uint Components;
        public uint Count;
        public uint Reserved;
        public long ParticleStride;
        public long ComponentStride;
        public ulong Generation;
        public IntPtr Data;
        public IntPtr Ids;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    internal partial struct NativeSnapshot
    {
        public uint StructSize;
        public uint Count;
        public uint Dimension;
        public uint ElementType;
        public ulong Step;
        public double Time;
        public IntPtr Positions;
        public IntPtr Velocities;
        public IntPtr Ids;
        public IntPtr Owner;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    internal partial struct NativeAnisotropyDesc
    {
        public uint StructSize;
        public uint First;
        public uint Count;
        public uint MinNeighbors;
        public double Radius;
        public double Smoothing;
        public double MaxRatio;
        public double LoneScale;
        public IntPtr Positions;
        public IntPtr Stretches;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct Stats
    {
        public uint StructSize;
        public uint Count;
        public uint Iterations;
        public uint NeighborsMax;
        public double NeighborsMean;
        public Vector3d CenterOfMass;
        public Vector3d PositionMin;
        public Vector3d PositionMax;
        public Vector3d Momentum;
        public double KineticEnergy;
        public double SpeedMax;
        public double DensityErrorMean;
        public double DensityErrorMax;
        public double DensityMean;
        public uint Asleep;
        public uint Squeezed;
        public double StepLimit;
        public uint LimitedBy;
        public uint Substeps;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct StageTime
    {
        [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 32)]
        public string Name;
        public double Milliseconds;
        public ulong Runs;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct Timings
    {
        public uint StructSize;
        public uint StageCount;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 24)]
        public StageTime[] Stages;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct PlanStage
    {
        [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 32)]
        public string Name;
        public uint RunsPerStep;
        public uint LaunchesPerStep;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct PlanArray
    {
        [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 32)]
        public string Name;
        public double BytesPerParticle;
        public ulong Bytes;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct Plan
    {
        public uint StructSize;
        public uint StageCount;
        public uint ArrayCount;
        public uint Reserved;
        [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 64)]
        public string Variant;
        public double BytesPerParticle;
        public ulong Bytes;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 24)]
        public PlanStage[] Stages;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 40)]
        public PlanArray[] Arrays;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct BackendInfo
    {
        public uint StructSize;
        public uint Available;
        public int Score;
        public uint DeviceType;
        [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 32)]
        public string Name;
        [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 96)]
        public string DeviceName;
        [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 96)]
        public string BuildId;
        [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 256)]
        public string Path;
        [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 256)]
        public string Reason;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct Info
    {
        public uint StructSize;
        public uint Dimension;
        public uint Precision;
        public uint Capacity;
        public uint Threads;
        public int Device;
        public uint DeviceType;
        public uint FellBack;
        public ulong Step;
        public double Time;
        [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 32)]
        public string Backend;
        [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 96)]
        public string DeviceName;
        [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 96)]
        public string BuildId;
        [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 256)]
        public string Path;
        [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 256)]
        public string FallbackReason;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct BatchInfo
    {
        public uint StructSize;
        public uint Worlds;
        public uint Threads;
        public uint DeviceType;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct DiffuseDesc
    {
        public uint StructSize;
        public uint Capacity;
        public uint Seed;
        public uint Interval;
        public uint FoamNeighbors;
        public uint BubbleNeighbors;
        public double TrappedAirMin;
        public double TrappedAirMax;
        public double WaveCrestMin;
        public double WaveCrestMax;
        public double EnergyMin;
        public double EnergyMax;
        public double TrappedAirRate;
        public double WaveCrestRate;
        public double LifetimeMin;
        public double LifetimeMax;
        public double Buoyancy;
        public double BubbleDrag;
        public double SprayDrag;
        public double Scatter;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct DiffuseInfo
    {
        public uint StructSize;
        public uint Capacity;
        public uint Count;
        public uint Spray;
        public uint Foam;
        public uint Bubbles;
        public double Time;
        public ulong Generated;
        public ulong Expired;
        public ulong Recycled;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    internal partial struct NativeDiffuseRead
    {
        public uint StructSize;
        public uint First;
        public uint Count;
        public uint ElementType;
        public uint Components;
        public uint Reserved;
        public ulong Stride;
        public IntPtr Positions;
        public IntPtr Velocities;
        public IntPtr Ages;
        public IntPtr Lives;
        public IntPtr Kinds;
        public IntPtr Ids;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct Volume
    {
        public uint StructSize;
        public uint Shape;
        public Vector3d Position;
        public Vector4d Orientation;
        public Vector3d HalfExtents;
        public Vector3d Axis;
        public double Radius;
        public double HalfLength;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct VolumeFlow
    {
        public uint StructSize;
        public uint Reserved;
        public double Volume;
        public double Fraction;
        public Vector3d Centre;
        public Vector3d Velocity;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    internal partial struct NativeSamples
    {
        public uint StructSize;
        public uint Count;
        public IntPtr Points;
        public IntPtr Densities;
        public IntPtr Velocities;
        public IntPtr Pressures;
        public IntPtr Wet;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    internal partial struct NativeSampleGrid
    {
        public uint StructSize;
        public Vector3u Counts;
        public Vector3d Origin;
        public Vector3d Step;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct Emitter
    {
        public uint StructSize;
        public uint Shape;
        public uint Recycle;
        public uint Seed;
        public Vector3d Position;
        public Vector3d Velocity;
        public Vector3d Across;
        public double HalfWidth;
        public double HalfHeight;
        public double Radius;
        public double Rate;
        public double Jitter;
        public double Lifetime;
        public uint Phase;
        public uint Reserved;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct Reservoir
    {
        public uint StructSize;
        public uint Phase;
        public Vector3d Position;
        public Vector4d Orientation;
        public Vector3d HalfExtents;
        public double Depth;
        public double Pressure;
        public ulong Added;
        public ulong Removed;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct InOut
    {
        public uint StructSize;
        public uint Emitters;
        public uint Drains;
        public uint Reserved;
        public ulong Emitted;
        public ulong Refused;
        public ulong Recycled;
        public ulong Drained;
        public ulong Expired;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct Phase
    {
        public uint StructSize;
        public uint User;
        public double RestDensity;
        public double Viscosity;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    internal partial struct NativeGridDesc
    {
        public uint StructSize;
        public uint Dimension;
        public Vector3u Nodes;
        public uint Reserved;
        public Vector3d Origin;
        public double Cell;
        public IntPtr Values;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    internal partial struct NativeMeshDesc
    {
        public uint StructSize;
        public uint Dimension;
        public uint VertexCount;
        public uint FaceCount;
        public IntPtr Vertices;
        public IntPtr Faces;
        public double Cell;
        public double Thickness;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    internal partial struct NativeHeightsDesc
    {
        public uint StructSize;
        public uint Dimension;
        public Vector2u Count;
        public IntPtr Heights;
        public double Spacing;
        public double Base;
        public double Cell;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    internal partial struct NativeHullDesc
    {
        public uint StructSize;
        public uint Dimension;
        public uint PointCount;
        public uint Reserved;
        public IntPtr Points;
        public double Cell;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public partial struct ShapeInfo
    {
        public uint StructSize;
        public uint Dimension;
        public Vector3u Nodes;
        public uint References;
        public Vector3d Origin;
        public double Cell;
        public Vector3d Lower;
        public Vector3d Upper;
        public double Volume;
        public double Area;
        public ulong Bytes;
        public ulong Hash;
    }

    public partial struct Collider
    {
        public uint StructSize;
        public uint Shape;
        public uint Inverted;
        public uint Path;
        public Vector3d Position;
        public Vector4d Orientation;
        public Vector3d Velocity;
        public Vector3d AngularVelocity;
        public Vector3d Axis;
        public Vector3d HalfExtents;
        public double Radius;
        public double HalfLength;
        public Vector3d HalfExtentsRate;
        public double RadiusRate;
        public double HalfLengthRate;
        public double Duration;
        public Pbf.Shape Geometry;
        public double Scale;
        public double ScaleRate;
        public double Friction;
        public double StaticFriction;
        public double NoSlip;
        public double Adhesion;
        public Vector3d LastVelocity;
        public Vector3d LastAngularVelocity;

        internal Collider(NativeCollider from)
        {
            StructSize = from.StructSize;
            Shape = from.Shape;
            Inverted = from.Inverted;
            Path = from.Path;
            Position = from.Position;
            Orientation = from.Orientation;
            Velocity = from.Velocity;
            AngularVelocity = from.AngularVelocity;
            Axis = from.Axis;
            HalfExtents = from.HalfExtents;
            Radius = from.Radius;
            HalfLength = from.HalfLength;
            HalfExtentsRate = from.HalfExtentsRate;
            RadiusRate = from.RadiusRate;
            HalfLengthRate = from.HalfLengthRate;
            Duration = from.Duration;
            Geometry = Pbf.Shape.At(from.Geometry);
            Scale = from.Scale;
            ScaleRate = from.ScaleRate;
            Friction = from.Friction;
            StaticFriction = from.StaticFriction;
            NoSlip = from.NoSlip;
            Adhesion = from.Adhesion;
            LastVelocity = from.LastVelocity;
            LastAngularVelocity = from.LastAngularVelocity;
        }

        internal NativeCollider ForC()
        {
            return new NativeCollider
            {
                StructSize = StructSize,
                Shape = Shape,
                Inverted = Inverted,
                Path = Path,
                Position = Position,
                Orientation = Orientation,
                Velocity = Velocity,
                AngularVelocity = AngularVelocity,
                Axis = Axis,
                HalfExtents = HalfExtents,
                Radius = Radius,
                HalfLength = HalfLength,
                HalfExtentsRate = HalfExtentsRate,
                RadiusRate = RadiusRate,
                HalfLengthRate = HalfLengthRate,
                Duration = Duration,
                Geometry = Pbf.Shape.AddressOf(Geometry),
                Scale = Scale,
                ScaleRate = ScaleRate,
                Friction = Friction,
                StaticFriction = StaticFriction,
                NoSlip = NoSlip,
                Adhesion = Adhesion,
                LastVelocity = LastVelocity,
                LastAngularVelocity = LastAngularVelocity
            };
        }
    }

    internal static class Native
    {
#if UNITY_IOS && !UNITY_EDITOR
        internal const string Library = "__Internal";
#else
        internal const string Library = "pbf";
#endif
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern IntPtr pbf_status_string(Status status);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern IntPtr pbf_last_error();
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_desc_init(ref NativeDesc desc, uint struct_size);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_params_init(ref Params parameters, uint struct_size);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_set_params(SolverHandle solver, IntPtr parameters);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_params(SolverHandle solver, ref Params parameters);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_collider_init(ref NativeCollider collider, uint struct_size, uint shape);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_set_colliders(SolverHandle solver, uint count, IntPtr colliders);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_move_colliders(SolverHandle solver, uint count, IntPtr targets, double duration);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_collider_count(SolverHandle solver, ref uint count);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_collider(SolverHandle solver, uint index, ref NativeCollider collider);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_collider_loads(SolverHandle solver, uint count, IntPtr loads);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_wall_loads(SolverHandle solver, uint count, IntPtr loads);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_read(SolverHandle solver, IntPtr read);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_write(SolverHandle solver, IntPtr write);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_keep_previous(SolverHandle solver, uint enabled);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_map(SolverHandle solver, uint field, ref NativeView view);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_unmap(IntPtr solver, uint field);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_export_dlpack(SolverHandle solver, uint field, out IntPtr tensor);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_set_snapshots(SolverHandle solver, uint snapshots);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_acquire_snapshot(SolverHandle solver, ref NativeSnapshot snapshot);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_release_snapshot(ref NativeSnapshot snapshot);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_anisotropies(SolverHandle solver, IntPtr anisotropy);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_stats(SolverHandle solver, ref Stats stats);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_step_limit(SolverHandle solver, ref double limit);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_set_timing(SolverHandle solver, uint enabled);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_timings(SolverHandle solver, ref Timings timings);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_plan(SolverHandle solver, ref Plan plan);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_backend_count(ref uint count);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_backend_info(IntPtr desc, uint index, ref BackendInfo info);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_load_backend(IntPtr path);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern uint pbf_version();
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_create(IntPtr desc, IntPtr parameters, out IntPtr solver);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern void pbf_destroy(IntPtr solver);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_step(SolverHandle solver, uint steps);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_begin_step(SolverHandle solver, uint steps);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_end_step(SolverHandle solver);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_cancel(SolverHandle solver);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_synchronize(SolverHandle solver);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_info(SolverHandle solver, ref Info info);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_count(SolverHandle solver, ref uint count);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_add_particles(SolverHandle solver, uint count, IntPtr positions, IntPtr velocities, ref uint first_id);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_remove_particles(SolverHandle solver, uint count, IntPtr ids);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_remove_in_box(SolverHandle solver, IntPtr lower, IntPtr upper, ref uint count);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_find_in_box(SolverHandle solver, IntPtr lower, IntPtr upper, uint room, IntPtr ids, ref uint count);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_positions(SolverHandle solver, uint first, uint count, IntPtr positions);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_set_positions(SolverHandle solver, uint first, uint count, IntPtr positions);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_velocities(SolverHandle solver, uint first, uint count, IntPtr velocities);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_set_velocities(SolverHandle solver, uint first, uint count, IntPtr velocities);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_ids(SolverHandle solver, uint first, uint count, IntPtr ids);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_densities(SolverHandle solver, uint first, uint count, IntPtr densities);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_set_accelerations(SolverHandle solver, uint first, uint count, IntPtr accelerations);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_pressures(SolverHandle solver, uint first, uint count, IntPtr pressures);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_save(SolverHandle solver, IntPtr buffer, ref ulong size);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_load(SolverHandle solver, IntPtr buffer, ulong size);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_hash(SolverHandle solver, ref ulong hash);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_batch_create(IntPtr desc, IntPtr parameters, uint worlds, out IntPtr batch);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern void pbf_batch_destroy(IntPtr batch);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_batch_get_info(BatchHandle batch, ref BatchInfo info);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_batch_get_world(BatchHandle batch, uint world, out IntPtr solver);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_batch_get_statuses(BatchHandle batch, IntPtr statuses);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_batch_get_sentence(BatchHandle batch, uint world, out IntPtr sentence);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_batch_step(BatchHandle batch, IntPtr mask, uint steps);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_batch_set_start(BatchHandle batch, IntPtr mask, IntPtr state, ulong size);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_batch_reset(BatchHandle batch, IntPtr mask);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_batch_set_gravity(BatchHandle batch, IntPtr mask, IntPtr gravity);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_batch_set_colliders(BatchHandle batch, IntPtr mask, uint count, IntPtr colliders);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_batch_move_colliders(BatchHandle batch, IntPtr mask, uint count, IntPtr positions, IntPtr orientations, double duration);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_batch_add_particles(BatchHandle batch, IntPtr counts, IntPtr positions, IntPtr velocities);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_batch_get_counts(BatchHandle batch, IntPtr counts);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_batch_read(BatchHandle batch, IntPtr mask, IntPtr read, ulong world_stride);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_batch_export_dlpack(BatchHandle batch, uint field, uint rows, out IntPtr tensor);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_diffuse_init(SolverHandle solver, ref DiffuseDesc desc, uint struct_size);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_set_diffuse(SolverHandle solver, IntPtr desc);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_diffuse(SolverHandle solver, ref DiffuseDesc desc);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_diffuse_info(SolverHandle solver, ref DiffuseInfo info);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_read_diffuse(SolverHandle solver, IntPtr read);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_add_diffuse(SolverHandle solver, uint count, IntPtr positions, IntPtr velocities, IntPtr lives);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_shift_diffuse(SolverHandle solver, IntPtr way);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_volume_init(ref Volume volume, uint struct_size, uint shape);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_find_in_volume(SolverHandle solver, IntPtr volume, uint capacity, IntPtr ids, ref uint count);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_measure_volumes(SolverHandle solver, uint count, IntPtr volumes, IntPtr flows);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_sample(SolverHandle solver, IntPtr samples);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_sample_on_grid(SolverHandle solver, IntPtr grid, IntPtr samples);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_cast_rays(SolverHandle solver, uint count, IntPtr origins, IntPtr directions, double length, IntPtr distances, IntPtr normals);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_levels(SolverHandle solver, uint count, IntPtr points, IntPtr levels);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_end_queries(SolverHandle solver);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_emitter_init(ref Emitter emitter, uint struct_size, uint shape);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_set_emitters(SolverHandle solver, uint count, IntPtr emitters);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_emitter(SolverHandle solver, uint index, ref Emitter emitter);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_set_drains(SolverHandle solver, uint count, IntPtr drains);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_drain(SolverHandle solver, uint index, ref Volume drain);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_reservoir_init(ref Reservoir reservoir, uint struct_size);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_set_reservoirs(SolverHandle solver, uint count, IntPtr reservoirs);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_reservoir_count(SolverHandle solver, ref uint count);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_reservoir(SolverHandle solver, uint index, ref Reservoir reservoir);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_in_out(SolverHandle solver, ref InOut in_out);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_phase_init(ref Phase phase, uint struct_size);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_set_phases(SolverHandle solver, uint count, IntPtr phases);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_phase_count(SolverHandle solver, ref uint count);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_phase(SolverHandle solver, uint index, ref Phase phase);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_set_particle_phases(SolverHandle solver, uint first, uint count, IntPtr phases);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_particle_phases(SolverHandle solver, uint first, uint count, IntPtr phases);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_shape_from_grid(IntPtr grid, out IntPtr shape);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_shape_from_mesh(IntPtr mesh, out IntPtr shape);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_shape_from_heights(IntPtr heights, out IntPtr shape);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_shape_from_points(IntPtr hull, out IntPtr shape);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_hold_shape(IntPtr shape);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern void pbf_release_shape(IntPtr shape);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_shape_info(ShapeHandle shape, ref ShapeInfo info);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_shape_distance(ShapeHandle shape, IntPtr point, ref double distance, IntPtr normal);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_get_shape_values(ShapeHandle shape, ulong count, IntPtr values);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_save_shape(ShapeHandle shape, IntPtr buffer, ref ulong size);
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        internal static extern Status pbf_load_shape(IntPtr buffer, ulong size, out IntPtr shape);
    }

    /// <summary>Sizes and offsets of the C compiler, for tests.</summary>
    internal static class Layout
    {
        internal static readonly Dictionary<Type, string[]> Structs = new Dictionary<Type, string[]>
        {
            { typeof(NativeAllocator), new[] { "32", "StructSize=0", "Reserved=4", "User=8", "Allocate=16", "Release=24" } },
            { typeof(NativeDesc), new[] { "112", "StructSize=0", "ApiVersion=4", "Dimension=8", "Precision=12", "Capacity=16", "Strict=20", "Backend=24", "Device=32", "Threads=36", "Stream=40", "Allocator=48", "Log=56", "LogUser=64", "Isa=72", "EnqueueTask=80", "FinishTask=88", "TaskUser=96", "Determinism=104", "Reserved=108" } },
            { typeof(Params), new[] { "592", "StructSize=0", "Kernel=4", "SmoothingRadius=8", "Spacing=16", "ParticleVolume=24", "TimeStep=32", "Iterations=40", "Collide=44", "Gravity=48", "Attraction=72", "AttractionCenter=80", "OverRelaxation=104", "Cfm=112", "Cohesion=120", "MinDiagonal=128", "WallDensity=136", "ScorrK=144", "ScorrDq=152", "ScorrN=160", "Solver=164", "Vorticity=168", "Viscosity=176", "DomainMin=184", "DomainMax=208", "WallVelocity=232", "WallAmplitude=280", "WallFrequency=328", "WallPhase=376", "SearchCellWidth=424", "SleepSpeed=432", "SleepTime=440", "Tolerance=448", "PressureGrid=456", "Prestabilization=464", "DampingCompensation=472", "AngularMomentumCorrection=480", "Drag=488", "DragVelocity=496", "MaxDepenetrationSpeed=520", "MaxSubsteps=528", "Loads=532", "ShearStressCorrection=536", "WallFriction=544", "WallStaticFriction=552", "WallNoSlip=560", "SurfaceTension=568", "Periodic=576", "Reserved=580", "WallAdhesion=584" } },
            { typeof(NativeCollider), new[] { "336", "StructSize=0", "Shape=4", "Inverted=8", "Path=12", "Position=16", "Orientation=40", "Velocity=72", "AngularVelocity=96", "Axis=120", "HalfExtents=144", "Radius=168", "HalfLength=176", "HalfExtentsRate=184", "RadiusRate=208", "HalfLengthRate=216", "Duration=224", "Geometry=232", "Scale=240", "ScaleRate=248", "Friction=256", "StaticFriction=264", "NoSlip=272", "Adhesion=280", "LastVelocity=288", "LastAngularVelocity=312" } },
            { typeof(ColliderLoad), new[] { "128", "StructSize=0", "Contacts=4", "Impulse=8", "AngularImpulse=32", "ImpulseSum=56", "AngularImpulseSum=80", "TimeSum=104", "Penetration=112", "WettedArea=120" } },
            { typeof(NativeReadDesc), new[] { "80", "StructSize=0", "Field=4", "First=8", "Count=12", "ElementType=16", "Components=20", "W=24", "Order=28", "Stride=32", "Data=40", "Behind=48", "WValue=56", "DeviceType=64", "Reserved=68", "Stream=72" } },
            { typeof(WriteDesc), new[] { "56", "StructSize=0", "Field=4", "First=8", "Count=12", "ElementType=16", "Components=20", "Stride=24", "Data=32", "DeviceType=40", "Reserved=44", "Stream=48" } },
            { typeof(NativeView), new[] { "72", "StructSize=0", "Field=4", "DeviceType=8", "DeviceId=12", "ElementType=16", "Components=20", "Count=24", "Reserved=28", "ParticleStride=32", "ComponentStride=40", "Generation=48", "Data=56", "Ids=64" } },
            { typeof(NativeSnapshot), new[] { "64", "StructSize=0", "Count=4", "Dimension=8", "ElementType=12", "Step=16", "Time=24", "Positions=32", "Velocities=40", "Ids=48", "Owner=56" } },
            { typeof(NativeAnisotropyDesc), new[] { "64", "StructSize=0", "First=4", "Count=8", "MinNeighbors=12", "Radius=16", "Smoothing=24", "MaxRatio=32", "LoneScale=40", "Positions=48", "Stretches=56" } },
            { typeof(Stats), new[] { "184", "StructSize=0", "Count=4", "Iterations=8", "NeighborsMax=12", "NeighborsMean=16", "CenterOfMass=24", "PositionMin=48", "PositionMax=72", "Momentum=96", "KineticEnergy=120", "SpeedMax=128", "DensityErrorMean=136", "DensityErrorMax=144", "DensityMean=152", "Asleep=160", "Squeezed=164", "StepLimit=168", "LimitedBy=176", "Substeps=180" } },
            { typeof(StageTime), new[] { "48", "Name=0", "Milliseconds=32", "Runs=40" } },
            { typeof(Timings), new[] { "1160", "StructSize=0", "StageCount=4", "Stages=8" } },
            { typeof(PlanStage), new[] { "40", "Name=0", "RunsPerStep=32", "LaunchesPerStep=36" } },
            { typeof(PlanArray), new[] { "48", "Name=0", "BytesPerParticle=32", "Bytes=40" } },
            { typeof(Plan), new[] { "2976", "StructSize=0", "StageCount=4", "ArrayCount=8", "Reserved=12", "Variant=16", "BytesPerParticle=80", "Bytes=88", "Stages=96", "Arrays=1056" } },
            { typeof(BackendInfo), new[] { "752", "StructSize=0", "Available=4", "Score=8", "DeviceType=12", "Name=16", "DeviceName=48", "BuildId=144", "Path=240", "Reason=496" } },
            { typeof(Info), new[] { "784", "StructSize=0", "Dimension=4", "Precision=8", "Capacity=12", "Threads=16", "Device=20", "DeviceType=24", "FellBack=28", "Step=32", "Time=40", "Backend=48", "DeviceName=80", "BuildId=176", "Path=272", "FallbackReason=528" } },
            { typeof(BatchInfo), new[] { "16", "StructSize=0", "Worlds=4", "Threads=8", "DeviceType=12" } },
            { typeof(DiffuseDesc), new[] { "136", "StructSize=0", "Capacity=4", "Seed=8", "Interval=12", "FoamNeighbors=16", "BubbleNeighbors=20", "TrappedAirMin=24", "TrappedAirMax=32", "WaveCrestMin=40", "WaveCrestMax=48", "EnergyMin=56", "EnergyMax=64", "TrappedAirRate=72", "WaveCrestRate=80", "LifetimeMin=88", "LifetimeMax=96", "Buoyancy=104", "BubbleDrag=112", "SprayDrag=120", "Scatter=128" } },
            { typeof(DiffuseInfo), new[] { "56", "StructSize=0", "Capacity=4", "Count=8", "Spray=12", "Foam=16", "Bubbles=20", "Time=24", "Generated=32", "Expired=40", "Recycled=48" } },
            { typeof(NativeDiffuseRead), new[] { "80", "StructSize=0", "First=4", "Count=8", "ElementType=12", "Components=16", "Reserved=20", "Stride=24", "Positions=32", "Velocities=40", "Ages=48", "Lives=56", "Kinds=64", "Ids=72" } },
            { typeof(Volume), new[] { "128", "StructSize=0", "Shape=4", "Position=8", "Orientation=32", "HalfExtents=64", "Axis=88", "Radius=112", "HalfLength=120" } },
            { typeof(VolumeFlow), new[] { "72", "StructSize=0", "Reserved=4", "Volume=8", "Fraction=16", "Centre=24", "Velocity=48" } },
            { typeof(NativeSamples), new[] { "48", "StructSize=0", "Count=4", "Points=8", "Densities=16", "Velocities=24", "Pressures=32", "Wet=40" } },
            { typeof(NativeSampleGrid), new[] { "64", "StructSize=0", "Counts=4", "Origin=16", "Step=40" } },
            { typeof(Emitter), new[] { "144", "StructSize=0", "Shape=4", "Recycle=8", "Seed=12", "Position=16", "Velocity=40", "Across=64", "HalfWidth=88", "HalfHeight=96", "Radius=104", "Rate=112", "Jitter=120", "Lifetime=128", "Phase=136", "Reserved=140" } },
            { typeof(Reservoir), new[] { "120", "StructSize=0", "Phase=4", "Position=8", "Orientation=32", "HalfExtents=64", "Depth=88", "Pressure=96", "Added=104", "Removed=112" } },
            { typeof(InOut), new[] { "56", "StructSize=0", "Emitters=4", "Drains=8", "Reserved=12", "Emitted=16", "Refused=24", "Recycled=32", "Drained=40", "Expired=48" } },
            { typeof(Phase), new[] { "24", "StructSize=0", "User=4", "RestDensity=8", "Viscosity=16" } },
            { typeof(NativeGridDesc), new[] { "64", "StructSize=0", "Dimension=4", "Nodes=8", "Reserved=20", "Origin=24", "Cell=48", "Values=56" } },
            { typeof(NativeMeshDesc), new[] { "48", "StructSize=0", "Dimension=4", "VertexCount=8", "FaceCount=12", "Vertices=16", "Faces=24", "Cell=32", "Thickness=40" } },
            { typeof(NativeHeightsDesc), new[] { "48", "StructSize=0", "Dimension=4", "Count=8", "Heights=16", "Spacing=24", "Base=32", "Cell=40" } },
            { typeof(NativeHullDesc), new[] { "32", "StructSize=0", "Dimension=4", "PointCount=8", "Reserved=12", "Points=16", "Cell=24" } },
            { typeof(ShapeInfo), new[] { "136", "StructSize=0", "Dimension=4", "Nodes=8", "References=20", "Origin=24", "Cell=48", "Lower=56", "Upper=80", "Volume=104", "Area=112", "Bytes=120", "Hash=128" } }
        };
    }
}
