using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;

namespace Pbf
{
    /// <summary>Arrays, and copies of structs, that stay where they are while C uses them.</summary>
    internal sealed class Pins : IDisposable
    {
        private readonly List<GCHandle> held = new List<GCHandle>();

        /// <summary>The address of an array's elements, or of a copy of a struct; null is 0.</summary>
        internal IntPtr Of(object what)
        {
            if (what == null) return IntPtr.Zero;
            var pin = GCHandle.Alloc(what, GCHandleType.Pinned);
            held.Add(pin);
            return pin.AddrOfPinnedObject();
        }

        public void Dispose()
        {
            foreach (var pin in held) pin.Free();
            held.Clear();
        }
    }

    /// <summary>What is looked at before C gets an array: it sees counts alone.</summary>
    internal static class Arrays
    {
        internal static uint SizeOf<T>() { return (uint)Marshal.SizeOf(typeof(T)); }

        internal static T Given<T>(T array, string name) where T : class
        {
            return array ?? throw PbfException.Invalid($"{name} is null");
        }

        /// <summary>Null is allowed: then it is not asked for.</summary>
        internal static void HasLength(string name, Array array, long wanted)
        {
            if (array != null && array.Length != wanted)
                throw PbfException.Invalid($"{name} has {array.Length} elements; it must have {wanted}");
        }

        /// <summary>How many rows of so many numbers an array has.</summary>
        internal static uint Rows(string name, Array array, uint numbers)
        {
            Given(array, name);
            if (numbers == 0 || array.Length % numbers != 0)
                throw PbfException.Invalid($"{name} has {array.Length} numbers, no multiple of {numbers}");
            return (uint)(array.Length / numbers);
        }

        internal static void OfPrecision(Array array, uint precision)
        {
            if ((array is float[]) != (precision == Constants.Float32))
                throw PbfException.Invalid("the array is not of the solver's precision, Desc.Precision");
        }

        internal static NativeCollider[] Colliders(Collider[] colliders, string name)
        {
            return Array.ConvertAll(Given(colliders, name), collider =>
            {
                var raw = collider.ForC();
                raw.StructSize = SizeOf<NativeCollider>();
                return raw;
            });
        }
    }
}
