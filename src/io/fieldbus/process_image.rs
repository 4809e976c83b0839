//! The process data of a device: bit fields in little-endian bytes, as EtherCAT transports them.
//! Source: ETG.1000.6 (process data), CiA 301 (data types).

/// Largest field, bits.
pub const MAX_FIELD_BITS: u16 = 32;

/// The process data of one device.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DeviceImage {
    /// What the device sends.
    pub inputs: Vec<u8>,
    /// What the device gets.
    pub outputs: Vec<u8>,
}

/// A field of 1 to 32 bits in the inputs or the outputs of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BitField {
    /// First bit; bit 0 is the lowest one of the first byte.
    pub first: u16,
    /// Number of bits, 1 to [`MAX_FIELD_BITS`].
    pub bits: u16,
}

impl BitField {
    /// The value, unsigned. Bits beyond the data read as 0.
    #[must_use]
    pub fn read(self, bytes: &[u8]) -> u32 {
        (0..self.bits.min(MAX_FIELD_BITS)).fold(0, |value, bit| {
            let at = usize::from(self.first + bit);
            let set = bytes.get(at / 8).is_some_and(|byte| byte >> (at % 8) & 1 == 1);
            value | u32::from(set) << bit
        })
    }

    /// The value, signed in two's complement.
    #[must_use]
    pub fn read_signed(self, bytes: &[u8]) -> i32 {
        let unused = u32::from(MAX_FIELD_BITS - self.bits.clamp(1, MAX_FIELD_BITS));
        (self.read(bytes) << unused).cast_signed() >> unused
    }

    /// Writes the lower bits of a value. Bits beyond the data are dropped.
    pub fn write(self, bytes: &mut [u8], value: u32) {
        for bit in 0..self.bits.min(MAX_FIELD_BITS) {
            let at = usize::from(self.first + bit);
            if let Some(byte) = bytes.get_mut(at / 8) {
                let mask = 1 << (at % 8);
                if value >> bit & 1 == 1 { *byte |= mask } else { *byte &= !mask }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A field keeps its value, and its neighbours keep theirs.
        #[test]
        fn a_field_is_read_as_it_was_written(first in 0_u16..40, bits in 1_u16..=32, value: u32, noise: [u8; 9]) {
            let field = BitField { first, bits };
            let mut bytes = noise;
            field.write(&mut bytes, value);
            let mask = if bits == 32 { u32::MAX } else { (1 << bits) - 1 };
            prop_assert_eq!(field.read(&bytes), value & mask);
            for bit in (0..first).chain(first + bits..72) {
                let at = BitField { first: bit, bits: 1 };
                prop_assert_eq!(at.read(&bytes), at.read(&noise));
            }
        }
    }

    #[test]
    fn a_field_is_little_endian_and_signed_in_twos_complement() {
        let mut bytes = [0; 4];
        BitField { first: 8, bits: 16 }.write(&mut bytes, 0x1234);
        assert_eq!(bytes, [0, 0x34, 0x12, 0]);
        assert_eq!(BitField { first: 0, bits: 16 }.read_signed(&[0xfe, 0xff]), -2);
        assert_eq!(BitField { first: 0, bits: 12 }.read_signed(&[0x00, 0x08]), -2_048);
        assert_eq!(BitField { first: 16, bits: 8 }.read(&[1]), 0, "beyond the data");
    }
}
