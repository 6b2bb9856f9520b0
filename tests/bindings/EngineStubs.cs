// As much of Unity's and Godot's declarations as the samples use, so that they are seen to compile.
using System;
using System.Collections.Generic;

namespace UnityEngine
{
    public class Object { }
    public class Component : Object { public Transform transform; }
    public class Behaviour : Component { public bool enabled; }
    public class MonoBehaviour : Behaviour { }
    public class Mesh : Object { public Vector3[] vertices; public int[] triangles; }
    public class MeshFilter : Component { public Mesh sharedMesh; }
    public class Material : Object { }
    public class Collider : Component { }
    public class Transform : Component
    {
        public Vector3 position;
        public Matrix4x4 localToWorldMatrix;
        public Vector3 InverseTransformPoint(Vector3 point) { return point; }
        public Vector3 TransformPoint(Vector3 point) { return point; }
    }
    public struct Vector3
    {
        public float x, y, z;
        public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
        public static Vector3 one { get { return new Vector3(1, 1, 1); } }
        public static Vector3 operator *(Vector3 a, float b) { return a; }
    }
    public struct Quaternion { public static Quaternion identity { get { return new Quaternion(); } } }
    public struct Matrix4x4
    {
        public static Matrix4x4 TRS(Vector3 at, Quaternion turned, Vector3 size) { return new Matrix4x4(); }
        public static Matrix4x4 operator *(Matrix4x4 a, Matrix4x4 b) { return a; }
    }
    public static class Debug
    {
        public static void LogWarning(object message) { }
        public static void LogException(Exception exception, Object context) { }
    }
    public static class Mathf
    {
        public static float Min(float a, float b) { return a; }
        public static int FloorToInt(float a) { return 0; }
    }
    public static class Time { public static float deltaTime { get { return 0; } } }
    public static class Graphics
    {
        public static void DrawMeshInstanced(Mesh mesh, int part, Material material, List<Matrix4x4> matrices) { }
    }
}

namespace Godot
{
    public class ExportAttribute : Attribute { }
    public class GodotObject { }
    public class Node : GodotObject
    {
        public T GetNode<T>(string path) where T : class { return null; }
        public virtual void _Ready() { }
        public virtual void _PhysicsProcess(double delta) { }
        public virtual void _ExitTree() { }
    }
    public class Node3D : Node { }
    public class MultiMeshInstance3D : Node3D { public MultiMesh Multimesh { get; set; } }
    public class MultiMesh : GodotObject
    {
        public int InstanceCount { get; set; }
        public int VisibleInstanceCount { get; set; }
        public void SetInstanceTransform(int instance, Transform3D transform) { }
    }
    public struct Vector3
    {
        public float X, Y, Z;
        public Vector3(float x, float y, float z) { X = x; Y = y; Z = z; }
    }
    public struct Basis { public static Basis Identity { get { return new Basis(); } } }
    public struct Transform3D { public Transform3D(Basis basis, Vector3 origin) { } }
    public static class GD { public static void PushError(string message) { } }
}
