//! `java.util.HashMap`, with its entries in Java's order: by the bucket that the hash code falls in, within a bucket by age.
//!
//! Java promises no order, but its order is the same on every run, and what models print depends on it.

use std::cmp::Ordering;
use std::collections::HashMap;

use super::hooks::natural;
use super::memory::Charge;
use super::value::Value;

/// In what order a map goes through its entries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// By the hash codes of the keys, as `HashMap` does.
    #[default]
    Hashed,
    /// In order of insertion, as `LinkedHashMap` does.
    Inserted,
    /// By the natural order of the keys, as `TreeMap` does.
    Natural,
}

/// A key with its hash code, and its value.
#[derive(Clone, Debug)]
struct Slot {
    hash: i32,
    entry: (Value, Value),
}

/// Values by key.
#[derive(Clone, Debug, Default)]
pub struct JavaMap {
    /// Places in `slots` by the hash code of the key.
    places: HashMap<i32, Vec<usize>>,
    /// Entries in order of insertion; `None` where one was removed.
    slots: Vec<Option<Slot>>,
    n_entries: usize,
    /// Most keys there ever were at one time: Java's table grows with them and never shrinks.
    n_most: usize,
    order: Order,
    /// What the entries take of the memory budget.
    pub charge: Charge,
}

impl JavaMap {
    /// An empty map.
    pub fn new(order: Order) -> Self {
        Self {
            order,
            ..Self::default()
        }
    }

    /// In what order it goes through its entries.
    pub fn order(&self) -> Order {
        self.order
    }

    /// Number of keys.
    pub fn len(&self) -> usize {
        self.n_entries
    }

    /// Whether there is no key.
    pub fn is_empty(&self) -> bool {
        self.n_entries == 0
    }

    /// Keys and values in the order in which Java goes through them.
    pub fn entries(&self) -> Vec<&(Value, Value)> {
        let mut all: Vec<&Slot> = self.slots.iter().flatten().collect();
        match self.order {
            Order::Hashed => {
                let mask = self.n_buckets() - 1;
                all.sort_by_key(|slot| {
                    let hash = slot.hash as u32;
                    (hash ^ (hash >> 16)) & mask
                });
            }
            Order::Inserted => {}
            Order::Natural => {
                all.sort_by(|a, b| natural(&a.entry.0, &b.entry.0).unwrap_or(Ordering::Equal));
            }
        }
        all.into_iter().map(|slot| &slot.entry).collect()
    }

    /// Whether both have the same keys with equal values; maps that stand in so many collections.
    pub(super) fn holds_same(&self, other: &Self, depth: usize) -> bool {
        let mut slots = self.slots.iter().flatten();
        self.len() == other.len()
            && slots.all(|slot| {
                let (key, value) = &slot.entry;
                let found = other.get(key, slot.hash);
                found.is_some_and(|found| found.equals_nested(value, depth))
            })
    }

    /// Length of Java's table: 16, doubled whenever it is more than three quarters full.
    fn n_buckets(&self) -> u32 {
        let mut n = 16_u32;
        while self.n_most > n as usize / 4 * 3 && n < 1 << 30 {
            n *= 2;
        }
        n
    }

    /// All keys and values; whoever changes a key leaves its hash code as it is.
    pub(super) fn parts_mut(&mut self) -> impl Iterator<Item = &mut Value> {
        let slots = self.slots.iter_mut().flatten();
        slots.flat_map(|slot| [&mut slot.entry.0, &mut slot.entry.1])
    }

    /// All keys and values.
    pub(super) fn into_parts(self) -> impl Iterator<Item = Value> {
        let slots = self.slots.into_iter().flatten();
        slots.flat_map(|slot| [slot.entry.0, slot.entry.1])
    }

    /// The keys with this hash code.
    pub fn keys_of(&self, hash: i32) -> Vec<Value> {
        let places = self.places.get(&hash).map_or(&[][..], Vec::as_slice);
        let slots = places
            .iter()
            .filter_map(|&place| self.slots[place].as_ref());
        slots.map(|slot| slot.entry.0.clone()).collect()
    }

    /// The value of `key`, which has this hash code.
    pub fn get(&self, key: &Value, hash: i32) -> Option<&Value> {
        let place = self.place(key, hash)?;
        self.slots[place].as_ref().map(|slot| &slot.entry.1)
    }

    /// Sets the value of `key`, which has this hash code, and gives the one before.
    pub fn insert(&mut self, key: Value, hash: i32, value: Value) -> Option<Value> {
        if let Some(place) = self.place(&key, hash) {
            return self.slots[place]
                .as_mut()
                .map(|slot| std::mem::replace(&mut slot.entry.1, value));
        }
        self.places.entry(hash).or_default().push(self.slots.len());
        let entry = (key, value);
        self.slots.push(Some(Slot { hash, entry }));
        self.n_entries += 1;
        self.n_most = self.n_most.max(self.n_entries);
        None
    }

    /// Removes `key`, which has this hash code, and gives its value.
    pub fn remove(&mut self, key: &Value, hash: i32) -> Option<Value> {
        let place = self.place(key, hash)?;
        if let Some(places) = self.places.get_mut(&hash) {
            places.retain(|&p| p != place);
        }
        self.n_entries -= 1;
        let removed = self.slots[place].take().map(|slot| slot.entry.1);
        if self.slots.len() > 2 * self.n_entries + 16 {
            self.compact();
        }
        removed
    }

    fn place(&self, key: &Value, hash: i32) -> Option<usize> {
        let places = self.places.get(&hash)?;
        let has_key = |&&place: &&usize| {
            let slot = self.slots[place].as_ref();
            slot.is_some_and(|slot| slot.entry.0.equals(key))
        };
        places.iter().find(has_key).copied()
    }

    fn compact(&mut self) {
        self.slots.retain(Option::is_some);
        self.places.clear();
        for (place, slot) in self.slots.iter().flatten().enumerate() {
            self.places.entry(slot.hash).or_default().push(place);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_keep_their_order_through_removals() {
        let mut map = JavaMap::default();
        for i in 0..100 {
            assert!(map.insert(Value::Int(i), i, Value::Int(i * i)).is_none());
        }
        for i in 0..95 {
            assert_eq!(
                map.remove(&Value::Int(i), i).and_then(|v| v.as_int()),
                Some(i * i)
            );
        }
        let keys = |map: &JavaMap| -> Vec<i32> {
            let entries = map.entries();
            entries.iter().filter_map(|(k, _)| k.as_int()).collect()
        };
        assert_eq!(keys(&map), [95, 96, 97, 98, 99]);
        assert_eq!(
            map.get(&Value::Int(97), 97).and_then(Value::as_int),
            Some(97 * 97)
        );
        assert!(map.get(&Value::Long(97), 97).is_none());
        assert_eq!(
            map.insert(Value::Int(97), 97, Value::Null)
                .and_then(|v| v.as_int()),
            Some(97 * 97)
        );
        assert_eq!((map.len(), map.is_empty()), (5, false));
    }
}
