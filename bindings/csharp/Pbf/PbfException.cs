using System;
using System.Runtime.InteropServices;
using System.Text;

namespace Pbf
{
    /// <summary>A call that failed: its status, and as message the library's sentence.</summary>
    public sealed class PbfException : Exception
    {
        public Status Status { get; }

        internal PbfException(Status status, string message) : base(message)
        {
            Status = status;
        }

        internal static PbfException Invalid(string message)
        {
            return new PbfException(Status.InvalidArgument, message);
        }

        /// <summary>Of the call that this thread has just made.</summary>
        internal static void Check(Status status)
        {
            if (status != Status.Ok) throw new PbfException(status, Text.From(Native.pbf_last_error()));
        }
    }

    /// <summary>C strings in UTF-8.</summary>
    internal static class Text
    {
        internal static string From(IntPtr text)
        {
            int length = 0;
            while (Marshal.ReadByte(text, length) != 0) ++length;
            var bytes = new byte[length];
            Marshal.Copy(text, bytes, 0, length);
            return Encoding.UTF8.GetString(bytes);
        }

        /// <summary>Calls with a copy for C, null for null.</summary>
        internal static T With<T>(string name, string text, Func<IntPtr, T> call)
        {
            if (text == null) return call(IntPtr.Zero);
            if (text.IndexOf('\0') >= 0) throw PbfException.Invalid(name + " has a zero character");
            var bytes = Encoding.UTF8.GetBytes(text + '\0');
            var pin = GCHandle.Alloc(bytes, GCHandleType.Pinned);
            try { return call(pin.AddrOfPinnedObject()); }
            finally { pin.Free(); }
        }
    }
}
