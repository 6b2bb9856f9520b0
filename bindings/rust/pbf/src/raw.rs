/// A type with a `raw` struct of C has the fields of that, by Deref; `sized` is that struct with the
/// size that it has, whatever a program has put there.
macro_rules! fields_of_c {
    ($name:ident, $raw:ident) => {
        impl $name {
            pub(crate) fn sized(&self) -> pbf_sys::$raw {
                pbf_sys::$raw {
                    struct_size: std::mem::size_of::<pbf_sys::$raw>() as u32,
                    ..**self
                }
            }
        }

        impl std::ops::Deref for $name {
            type Target = pbf_sys::$raw;
            fn deref(&self) -> &pbf_sys::$raw {
                &self.raw
            }
        }

        impl std::ops::DerefMut for $name {
            fn deref_mut(&mut self) -> &mut pbf_sys::$raw {
                &mut self.raw
            }
        }
    };
}
pub(crate) use fields_of_c;

/// A struct of C whose bytes are 0 but for its size.
macro_rules! empty {
    ($raw:ident) => {{
        let mut raw: pbf_sys::$raw = unsafe { std::mem::zeroed() };
        raw.struct_size = std::mem::size_of::<pbf_sys::$raw>() as u32;
        raw
    }};
}
pub(crate) use empty;
