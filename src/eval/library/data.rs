//! Tables of a model (`DatasetRef`), their rows, and the charts made of them.

use std::sync::Arc;

use super::{Arguments, Context, new_object};
use crate::eval::memory::Charge;
use crate::eval::object::{Data, Object};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

/// More rows or columns than this are taken for a fault.
const MAX_SIDE: usize = 1 << 20;
/// What a cell is counted as in the memory budget, in bytes.
const CELL_BYTES: u64 = 24;

/// A table: rows of values with names of columns and rows.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Its name.
    pub title: String,
    /// Names of the columns; null where none was given.
    pub columns: Vec<Value>,
    /// The rows.
    pub rows: Vec<TableRow>,
    n_cells: u64,
    charge: Charge,
}

/// A row of a table.
#[derive(Clone, Debug, Default)]
pub struct TableRow {
    /// Its name; null if none was given.
    pub key: Value,
    /// Its values; null where none was given.
    pub cells: Vec<Value>,
}

impl Table {
    /// A table with these columns and rows.
    pub fn of(title: &str, columns: Vec<Value>, rows: Vec<TableRow>) -> Self {
        Self {
            title: title.to_owned(),
            columns,
            rows,
            ..Self::default()
        }
    }

    /// Number of columns that have a name or a value.
    pub fn n_columns(&self) -> usize {
        let longest = self.rows.iter().map(|row| row.cells.len()).max();
        self.columns.len().max(longest.unwrap_or(0))
    }

    /// All values that it holds.
    pub fn take_parts(&mut self, parts: &mut Vec<Value>) {
        parts.append(&mut self.columns);
        for row in &mut self.rows {
            parts.push(std::mem::take(&mut row.key));
            parts.append(&mut row.cells);
        }
    }
}

/// A new table of this name; tables of one name are one table.
pub(super) fn make(cx: &mut Context<'_>, class: ClassId, args: &[Value]) -> Result<Value, Trap> {
    let title = args.text(0).to_owned();
    if let Some(known) = cx.machine.tables.get(&title) {
        return Ok(Value::Object(Arc::clone(known)));
    }
    let table = Table {
        title: title.clone(),
        ..Table::default()
    };
    let object = Arc::new(Object::new(class, Data::Table(Box::new(table))));
    cx.machine.tables.insert(title, Arc::clone(&object));
    Ok(Value::Object(object))
}

pub(super) fn same(_: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(args.at(0).clone())
}

/// Works on the table that is the receiver.
fn on_table<T: Default>(
    cx: &Context<'_>,
    args: &[Value],
    f: impl FnOnce(&mut Table) -> Result<T, Trap>,
) -> Result<T, Trap> {
    match &mut *cx.object(args, 0)?.lock() {
        Data::Table(table) => f(table),
        _ => Ok(T::default()),
    }
}

fn side(cx: &Context<'_>, index: i32) -> Result<usize, Trap> {
    let place = usize::try_from(index).ok().filter(|i| *i < MAX_SIDE);
    place.ok_or_else(|| {
        let message = format!("row or column {index} of a table (allowed are 0 to {MAX_SIDE})");
        cx.exception(ClassId::IndexOutOfBoundsException, message)
    })
}

/// Makes room for the cell, and pays for it.
fn ensure<'t>(
    cx: &Context<'_>,
    table: &'t mut Table,
    row: usize,
    column: Option<usize>,
) -> Result<&'t mut TableRow, Trap> {
    let n_columns = column.map_or(0, |c| c + 1);
    let n_old = table.rows.get(row).map_or(0, |r| r.cells.len());
    let new_rows = (row + 1).saturating_sub(table.rows.len());
    table.n_cells += (n_columns.saturating_sub(n_old) + 4 * new_rows) as u64;
    let needed = CELL_BYTES * table.n_cells;
    if needed > table.charge.bytes() {
        table.charge = cx
            .machine
            .charge(2 * needed)
            .map_err(|trap| trap.at(cx.span))?;
    }
    if table.rows.len() <= row {
        table.rows.resize(row + 1, TableRow::default());
    }
    let found = &mut table.rows[row];
    if found.cells.len() < n_columns {
        found.cells.resize(n_columns, Value::Null);
    }
    Ok(found)
}

pub(super) fn clear(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let old = on_table(cx, args, |table| {
        let title = table.title.clone();
        Ok(std::mem::replace(
            table,
            Table {
                title,
                ..Table::default()
            },
        ))
    })?;
    drop(old);
    Ok(Value::Null)
}

pub(super) fn set_title(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_table(cx, args, |table| {
        table.title = args.text(1).to_owned();
        Ok(args.at(0).clone())
    })
}

pub(super) fn set_column_key(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let column = side(cx, args.int(1))?;
    on_table(cx, args, |table| {
        if table.columns.len() <= column {
            table.columns.resize(column + 1, Value::Null);
        }
        table.columns[column] = args.at(2).clone();
        Ok(args.at(0).clone())
    })
}

pub(super) fn column_key(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let column = side(cx, args.int(1))?;
    on_table(cx, args, |table| {
        Ok(table.columns.get(column).cloned().unwrap_or_default())
    })
}

pub(super) fn set_row_key(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let row = side(cx, args.int(1))?;
    on_table(cx, args, |table| {
        ensure(cx, table, row, None)?.key = args.at(2).clone();
        Ok(args.at(0).clone())
    })
}

pub(super) fn row_key(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let row = side(cx, args.int(1))?;
    on_table(cx, args, |table| {
        Ok(table
            .rows
            .get(row)
            .map(|r| r.key.clone())
            .unwrap_or_default())
    })
}

pub(super) fn n_columns(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_table(cx, args, |table| Ok(Value::Int(table.n_columns() as i32)))
}

pub(super) fn n_rows(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_table(cx, args, |table| Ok(Value::Int(table.rows.len() as i32)))
}

pub(super) fn cell(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (row, column) = (side(cx, args.int(1))?, side(cx, args.int(2))?);
    on_table(cx, args, |table| {
        let cell = table.rows.get(row).and_then(|r| r.cells.get(column));
        Ok(cell.cloned().unwrap_or_default())
    })
}

pub(super) fn set_cell(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (row, column) = (side(cx, args.int(1))?, side(cx, args.int(2))?);
    on_table(cx, args, |table| {
        ensure(cx, table, row, Some(column))?.cells[column] = args.at(3).clone();
        Ok(Value::Null)
    })
}

fn row_object(cx: &Context<'_>, args: &[Value], index: usize) -> Result<Value, Trap> {
    let table = Arc::clone(cx.object(args, 0)?);
    Ok(new_object(ClassId::DatasetRow, Data::Row(table, index)))
}

/// The row of this number; rows up to it are made if they are not there yet.
pub(super) fn row(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let row = side(cx, args.int(1))?;
    on_table(cx, args, |table| ensure(cx, table, row, None).map(drop))?;
    row_object(cx, args, row)
}

pub(super) fn add_row(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let n = on_table(cx, args, |table| {
        let n = side(cx, i32::try_from(table.rows.len()).unwrap_or(i32::MAX))?;
        ensure(cx, table, n, None)?;
        Ok(n)
    })?;
    row_object(cx, args, n)
}

/// Works on the table and the number of the row that is the receiver.
fn on_row<T: Default>(
    cx: &Context<'_>,
    args: &[Value],
    f: impl FnOnce(&mut Table, usize) -> Result<T, Trap>,
) -> Result<T, Trap> {
    let (table, row) = match &*cx.object(args, 0)?.lock() {
        Data::Row(table, row) => (Arc::clone(table), *row),
        _ => return Ok(T::default()),
    };
    match &mut *table.lock() {
        Data::Table(table) => f(table, row),
        _ => Ok(T::default()),
    }
}

pub(super) fn row_set(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let column = side(cx, args.int(1))?;
    on_row(cx, args, |table, row| {
        ensure(cx, table, row, Some(column))?.cells[column] = args.at(2).clone();
        Ok(())
    })?;
    Ok(args.at(0).clone())
}

/// `row << value`: appends a value.
pub(super) fn row_append(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_row(cx, args, |table, row| {
        let n = table.rows.get(row).map_or(0, |r| r.cells.len());
        ensure(cx, table, row, Some(n))?.cells[n] = args.at(1).clone();
        Ok(())
    })?;
    Ok(args.at(0).clone())
}

pub(super) fn row_get(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let column = side(cx, args.int(1))?;
    on_row(cx, args, |table, row| {
        let cell = table.rows.get(row).and_then(|r| r.cells.get(column));
        Ok(cell.cloned().unwrap_or_default())
    })
}

pub(super) fn row_set_key(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_row(cx, args, |table, row| {
        ensure(cx, table, row, None)?.key = args.at(1).clone();
        Ok(Value::Null)
    })
}

/// `chart(table, kind)`: notes that the table is to be drawn.
pub(super) fn chart(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let table = Arc::clone(cx.object(args, 0)?);
    let kind = args.int(1);
    let charts = &mut cx.machine.charts;
    match charts
        .iter_mut()
        .find(|(known, _)| Arc::ptr_eq(known, &table))
    {
        Some((_, known)) => *known = kind,
        None => charts.push((table, kind)),
    }
    Ok(Value::Null)
}
