//! What serde asks of a reader: structs, lists and enums out of a text.

use super::{Fault, Message, Order, Reader, expected, fault};
use serde::de::{self, DeserializeSeed, EnumAccess, SeqAccess, VariantAccess, Visitor};
use serde::forward_to_deserialize_any;

impl<'t> Reader<'t> {
    /// The fields of the object that begins here.
    #[inline(never)]
    #[cfg_attr(small, optimize(size))]
    pub fn object(&mut self, fields: &'static [&'static str]) -> Result<Object<'_, 't>, Fault> {
        if self.peek() != Some(b'{') {
            return expected("an object, `{`");
        }
        let start = self.at;
        self.at += 1;
        let index = match self.order {
            Order::Written => None,
            Order::Any | Order::Lenient => Some(self.index(fields)?),
        };
        Ok(Object {
            begun: start,
            start,
            fields,
            next: 0,
            index,
            due: None,
            missing: None,
            reader: self,
        })
    }

    /// Where the values of the fields are.
    #[cfg_attr(small, optimize(size))]
    fn index(&mut self, fields: &'static [&'static str]) -> Result<Index, Fault> {
        let mut places = vec![None; fields.len()];
        let mut first = true;
        while self.peek() != Some(b'}') {
            if !first {
                self.expect(b',')?;
            }
            first = false;
            self.peek();
            let place = self.at;
            let key = self.string()?;
            let field = fields.iter().position(|field| *field == key);
            let wrong = match field {
                Some(field) if places[field].is_some() => format!("duplicate field `{key}`"),
                None if self.order != Order::Lenient => format!(
                    "unknown field `{key}`, expected one of `{}`",
                    fields.join("`, `")
                ),
                _ => String::new(),
            };
            if !wrong.is_empty() {
                self.at = place;
                return fault(wrong);
            }
            self.expect(b':')?;
            let begun = self.at;
            self.skip()?;
            if let Some(field) = field {
                places[field] = Some((begun, self.at));
            }
        }
        self.at += 1;
        let end = self.at;
        Ok(Index { places, end })
    }

    /// The list that begins here.
    #[inline(never)]
    #[cfg_attr(small, optimize(size))]
    fn list(&mut self) -> Result<List<'_, 't>, Fault> {
        if self.peek() != Some(b'[') {
            return expected("a list, `[`");
        }
        self.at += 1;
        Ok(List {
            first: true,
            reader: self,
        })
    }
}

/// Elements of a list.
struct List<'r, 't> {
    reader: &'r mut Reader<'t>,
    first: bool,
}

impl List<'_, '_> {
    /// Whether there is one more, where the reader then stands.
    #[inline(never)]
    #[cfg_attr(small, optimize(size))]
    fn more(&mut self) -> Result<bool, Fault> {
        let first = std::mem::replace(&mut self.first, false);
        match self.reader.peek() {
            Some(b']') => Ok(false),
            _ if first => Ok(true),
            Some(b',') => {
                self.reader.at += 1;
                Ok(true)
            }
            _ => expected("`,` or `]`"),
        }
    }
}

impl<'t> SeqAccess<'t> for List<'_, 't> {
    type Error = Fault;

    /// A function for each kind of value, not for each field.
    #[inline(never)]
    #[cfg_attr(small, optimize(size))]
    fn next_element_seed<T: DeserializeSeed<'t>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Fault> {
        if !self.more()? {
            return Ok(None);
        }
        seed.deserialize(&mut *self.reader).map(Some)
    }
}

/// Where the values of an object's fields begin and end, and where the object ends.
struct Index {
    places: Vec<Option<(usize, usize)>>,
    end: usize,
}

/// Fields of an object, in the struct's order: a sequence of their values. Of one that is not there
/// the element is what `null` reads as; where it cannot be null there is none, which serde replaces
/// by the field's default or refuses.
pub struct Object<'r, 't> {
    reader: &'r mut Reader<'t>,
    /// Where the value of the last field begins.
    begun: usize,
    start: usize,
    fields: &'static [&'static str],
    next: usize,
    index: Option<Index>,
    /// Where the last value must end.
    due: Option<usize>,
    /// The last field, if there was none.
    missing: Option<&'static str>,
}

impl<'t> Object<'_, 't> {
    /// Goes to the value of the next field, if there is one.
    #[inline(never)]
    #[cfg_attr(small, optimize(size))]
    fn find(&mut self) -> Result<bool, Fault> {
        self.in_full()?;
        self.missing = None;
        let Some(field) = self.fields.get(self.next) else {
            return Ok(false);
        };
        let place = match &self.index {
            Some(index) => {
                let place = index.places[self.next];
                self.due = place.map(|(_, end)| end);
                place.map(|(begun, _)| begun)
            }
            None => self.follows(field)?,
        };
        self.next += 1;
        if let Some(place) = place {
            self.reader.at = place;
            self.begun = place;
        } else {
            self.missing = Some(field);
        }
        Ok(place.is_some())
    }

    /// The last value must have been read to its end.
    fn in_full(&self) -> Result<(), Fault> {
        match self.due {
            Some(end) if end != self.reader.at => expected("`,` or `}`"),
            _ => Ok(()),
        }
    }

    /// Where the value of `field` begins, if it is the next one.
    #[cfg_attr(small, optimize(size))]
    fn follows(&mut self, field: &str) -> Result<Option<usize>, Fault> {
        let here = self.reader.at;
        let first = here == self.start + 1;
        if !first {
            if self.reader.peek() != Some(b',') {
                return Ok(None);
            }
            self.reader.at += 1;
        }
        self.reader.peek();
        let rest = &self.reader.text.as_bytes()[self.reader.at..];
        let key = rest
            .strip_prefix(b"\"")
            .and_then(|rest| rest.strip_prefix(field.as_bytes()))
            .is_some_and(|rest| rest.first() == Some(&b'"'));
        if !key {
            self.reader.at = here;
            return Ok(None);
        }
        self.reader.at += field.len() + 2;
        self.reader.expect(b':')?;
        Ok(Some(self.reader.at))
    }

    /// There must be no further field.
    #[inline(never)]
    #[cfg_attr(small, optimize(size))]
    pub fn end(self) -> Result<(), Fault> {
        self.in_full()?;
        match self.index {
            Some(index) => self.reader.at = index.end,
            None => self.reader.expect(b'}')?,
        }
        Ok(())
    }

    /// `fault`, or that the last field is missing.
    #[cold]
    #[inline(never)]
    #[cfg_attr(small, optimize(size))]
    fn explained(&mut self, fault: Fault) -> Fault {
        match self.missing {
            Some(field) => {
                self.reader.at = self.start;
                de::Error::missing_field(field)
            }
            None => fault,
        }
    }

    /// The text of the last value that was read.
    pub fn last(&self) -> &'t str {
        &self.reader.text[self.begun..self.reader.at]
    }

    /// The value of the next field, which must be there.
    pub fn required<T: de::Deserialize<'t>>(&mut self) -> Result<T, Fault> {
        match self.next_element()? {
            Some(value) => Ok(value),
            None => Err(self.explained(Fault(Box::new(Message {
                text: String::new(),
            })))),
        }
    }
}

impl<'t> SeqAccess<'t> for Object<'_, 't> {
    type Error = Fault;

    /// A function for each kind of value, not for each field.
    #[inline(never)]
    #[cfg_attr(small, optimize(size))]
    fn next_element_seed<T: DeserializeSeed<'t>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Fault> {
        let kept = (self.reader.text, self.reader.at);
        let found = self.find()?;
        if !found {
            (self.reader.text, self.reader.at) = ("null", 0);
        }
        let value = seed.deserialize(&mut *self.reader);
        if found {
            return value.map(Some);
        }
        (self.reader.text, self.reader.at) = kept;
        Ok(value.ok())
    }
}

/// An enum: the name of a variant without fields, or an object of one name and what belongs to it.
struct Variant<'r, 't> {
    reader: &'r mut Reader<'t>,
    bare: bool,
}

impl<'t> EnumAccess<'t> for Variant<'_, 't> {
    type Error = Fault;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'t>>(self, seed: V) -> Result<(V::Value, Self), Fault> {
        let value = seed.deserialize(&mut *self.reader)?;
        if !self.bare {
            self.reader.expect(b':')?;
        }
        Ok((value, self))
    }
}

impl Variant<'_, '_> {
    fn must_be_bare(&self, bare: bool) -> Result<(), Fault> {
        match bare {
            _ if bare == self.bare => Ok(()),
            true => expected("a name alone"),
            false => expected("an object of a name and a value"),
        }
    }
}

impl<'t> VariantAccess<'t> for Variant<'_, 't> {
    type Error = Fault;

    fn unit_variant(self) -> Result<(), Fault> {
        self.must_be_bare(true)
    }

    fn newtype_variant_seed<T: DeserializeSeed<'t>>(self, seed: T) -> Result<T::Value, Fault> {
        self.must_be_bare(false)?;
        seed.deserialize(self.reader)
    }

    fn tuple_variant<V: Visitor<'t>>(self, length: usize, visitor: V) -> Result<V::Value, Fault> {
        self.must_be_bare(false)?;
        de::Deserializer::deserialize_tuple(self.reader, length, visitor)
    }

    fn struct_variant<V: Visitor<'t>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        self.must_be_bare(false)?;
        de::Deserializer::deserialize_struct(self.reader, "", fields, visitor)
    }
}

impl<'t> de::Deserializer<'t> for &mut Reader<'t> {
    type Error = Fault;

    /// The model tells of each of its values what it is.
    fn deserialize_any<V: Visitor<'t>>(self, _: V) -> Result<V::Value, Fault> {
        expected("a value of a known kind")
    }

    fn deserialize_bool<V: Visitor<'t>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_bool(self.boolean()?)
    }

    fn deserialize_u32<V: Visitor<'t>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_u64(self.unsigned()?)
    }

    fn deserialize_u64<V: Visitor<'t>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_u64(self.unsigned()?)
    }

    fn deserialize_f64<V: Visitor<'t>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_f64(self.float()?)
    }

    fn deserialize_string<V: Visitor<'t>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_string(self.string()?.into_owned())
    }

    fn deserialize_identifier<V: Visitor<'t>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_str(&self.string()?)
    }

    #[cfg_attr(small, optimize(size))]
    fn deserialize_option<V: Visitor<'t>>(self, visitor: V) -> Result<V::Value, Fault> {
        if self.word("null") {
            visitor.visit_none()
        } else {
            visitor.visit_some(self)
        }
    }

    #[cfg_attr(small, optimize(size))]
    fn deserialize_seq<V: Visitor<'t>>(self, visitor: V) -> Result<V::Value, Fault> {
        let mut list = self.list()?;
        let value = visitor.visit_seq(&mut list)?;
        self.expect(b']')?;
        Ok(value)
    }

    fn deserialize_tuple<V: Visitor<'t>>(self, _: usize, visitor: V) -> Result<V::Value, Fault> {
        self.deserialize_seq(visitor)
    }

    #[cfg_attr(small, optimize(size))]
    fn deserialize_struct<V: Visitor<'t>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        let mut object = self.object(fields)?;
        match visitor.visit_seq(&mut object) {
            Ok(value) => object.end().map(|()| value),
            Err(fault) => Err(object.explained(fault)),
        }
    }

    #[cfg_attr(small, optimize(size))]
    fn deserialize_enum<V: Visitor<'t>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        let bare = self.peek() != Some(b'{');
        self.at += usize::from(!bare);
        let value = visitor.visit_enum(Variant {
            reader: &mut *self,
            bare,
        })?;
        if !bare {
            self.expect(b'}')?;
        }
        Ok(value)
    }

    forward_to_deserialize_any! {
        <V: Visitor<'t>>
        i8 i16 i32 i64 i128 u8 u16 u128 f32 char str bytes byte_buf unit unit_struct newtype_struct
        tuple_struct map ignored_any
    }
}
