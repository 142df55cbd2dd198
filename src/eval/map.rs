//! `java.util.HashMap`, with its entries in Java's order: by the bucket that the hash code falls in, within a bucket by age.
//!
//! Java promises no order, but its order is the same on every run, and what models print depends on it.

use std::collections::HashMap;

use super::memory::Charge;
use super::value::Value;

/// Values by key.
#[derive(Clone, Debug, Default)]
pub struct JavaMap {
    /// Places in `entries` by the hash code of the key.
    places: HashMap<i32, Vec<usize>>,
    /// Key and value in order of insertion; `None` where one was removed.
    entries: Vec<Option<(Value, Value)>>,
    n_entries: usize,
    /// Most keys there ever were at one time: Java's table grows with them and never shrinks.
    n_most: usize,
    /// Whether entries stay in order of insertion, as in a `LinkedHashMap`.
    keeps_order: bool,
    /// What the entries take of the memory budget.
    pub charge: Charge,
}

impl JavaMap {
    /// A map, in order of insertion or in Java's.
    pub fn new(keeps_order: bool) -> Self {
        Self {
            keeps_order,
            ..Self::default()
        }
    }

    /// Whether entries stay in order of insertion.
    pub fn keeps_order(&self) -> bool {
        self.keeps_order
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
        let mut all: Vec<_> = self.entries.iter().flatten().collect();
        if !self.keeps_order {
            let mask = self.n_buckets() - 1;
            all.sort_by_key(|(key, _)| {
                let hash = key.hash_code() as u32;
                (hash ^ (hash >> 16)) & mask
            });
        }
        all
    }

    /// Length of Java's table: 16, doubled whenever it is more than three quarters full.
    fn n_buckets(&self) -> u32 {
        let mut n = 16_u32;
        while self.n_most > n as usize / 4 * 3 && n < 1 << 30 {
            n *= 2;
        }
        n
    }

    /// All keys and values.
    pub(super) fn into_parts(self) -> impl Iterator<Item = Value> {
        self.entries
            .into_iter()
            .flatten()
            .flat_map(|(key, value)| [key, value])
    }

    /// The value of `key`.
    pub fn get(&self, key: &Value) -> Option<&Value> {
        let place = self.place(key)?;
        self.entries[place].as_ref().map(|(_, value)| value)
    }

    /// Sets the value of `key` and gives the one before.
    pub fn insert(&mut self, key: Value, value: Value) -> Option<Value> {
        if let Some(place) = self.place(&key) {
            return self.entries[place]
                .as_mut()
                .map(|(_, old)| std::mem::replace(old, value));
        }
        self.places
            .entry(key.hash_code())
            .or_default()
            .push(self.entries.len());
        self.entries.push(Some((key, value)));
        self.n_entries += 1;
        self.n_most = self.n_most.max(self.n_entries);
        None
    }

    /// Removes `key` and gives its value.
    pub fn remove(&mut self, key: &Value) -> Option<Value> {
        let place = self.place(key)?;
        if let Some(places) = self.places.get_mut(&key.hash_code()) {
            places.retain(|&p| p != place);
        }
        self.n_entries -= 1;
        let removed = self.entries[place].take().map(|(_, value)| value);
        if self.entries.len() > 2 * self.n_entries + 16 {
            self.compact();
        }
        removed
    }

    fn place(&self, key: &Value) -> Option<usize> {
        let places = self.places.get(&key.hash_code())?;
        let has_key = |&&place: &&usize| {
            self.entries[place]
                .as_ref()
                .is_some_and(|(k, _)| k.equals(key))
        };
        places.iter().find(has_key).copied()
    }

    fn compact(&mut self) {
        self.entries.retain(Option::is_some);
        self.places.clear();
        for (place, (key, _)) in self.entries.iter().flatten().enumerate() {
            self.places.entry(key.hash_code()).or_default().push(place);
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
            assert!(map.insert(Value::Int(i), Value::Int(i * i)).is_none());
        }
        for i in 0..95 {
            assert_eq!(
                map.remove(&Value::Int(i)).and_then(|v| v.as_int()),
                Some(i * i)
            );
        }
        let keys = |map: &JavaMap| -> Vec<i32> {
            let entries = map.entries();
            entries.iter().filter_map(|(k, _)| k.as_int()).collect()
        };
        assert_eq!(keys(&map), [95, 96, 97, 98, 99]);
        assert_eq!(
            map.get(&Value::Int(97)).and_then(Value::as_int),
            Some(97 * 97)
        );
        assert!(map.get(&Value::Long(97)).is_none());
        assert_eq!(
            map.insert(Value::Int(97), Value::Null)
                .and_then(|v| v.as_int()),
            Some(97 * 97)
        );
        assert_eq!((map.len(), map.is_empty()), (5, false));
    }
}
