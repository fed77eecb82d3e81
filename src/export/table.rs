//! Tables of an evaluation as CSV and Parquet.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;

use super::ExportError;
use super::csv::Fields;
use super::output::Output;
use crate::eval::table::{Cells, Column, Table};

/// Writes a table as CSV; what is not known is empty.
///
/// # Errors
/// If it cannot be written.
pub fn write_csv(table: &Table, out: &Path) -> Result<(), ExportError> {
    let mut output = Output::create(out, true)?;
    let failed = output.failed();
    let mut head = Fields::default();
    for column in &table.columns {
        head.push(column.name);
    }
    output
        .write_all(head.into_line().as_bytes())
        .map_err(&failed)?;
    for row in 0..table.rows() {
        let mut fields = Fields::default();
        for column in &table.columns {
            match &column.cells {
                Cells::Text(cells) => fields.push(&cells[row]),
                Cells::Whole(cells) => {
                    fields.push(&cells[row].map_or_else(String::new, |n| n.to_string()));
                }
                Cells::Number(cells) => {
                    fields.push(&cells[row].map_or_else(String::new, |n| format!("{n:?}")));
                }
            }
        }
        output
            .write_all(fields.into_line().as_bytes())
            .map_err(&failed)?;
    }
    output.commit()
}

/// Writes a table as Parquet, with what each column is in the file's metadata.
///
/// # Errors
/// If it cannot be written.
pub fn write_parquet(table: &Table, out: &Path) -> Result<(), ExportError> {
    let mut output = Output::create(out, true)?;
    let path = out.to_owned();
    write(table, &mut output).map_err(|error| ExportError::Format {
        path,
        what: error.to_string(),
    })?;
    output.commit()
}

fn write(table: &Table, output: &mut Output) -> Result<(), ParquetError> {
    let fields = table.columns.iter().map(|c| Ok(Arc::new(field(c)?)));
    let fields = fields.collect::<Result<Vec<_>, ParquetError>>()?;
    let schema = Type::group_type_builder(table.name)
        .with_fields(fields)
        .build()?;
    let about = table.columns.iter();
    let about = about.map(|c| KeyValue::new(c.name.to_owned(), c.about.to_owned()));
    let properties = WriterProperties::builder()
        .set_key_value_metadata(Some(about.collect()))
        .set_created_by(format!("poescope {}", env!("CARGO_PKG_VERSION")))
        .build();
    let mut file = SerializedFileWriter::new(output, Arc::new(schema), Arc::new(properties))?;
    let mut rows = file.next_row_group()?;
    for column in &table.columns {
        let Some(mut writer) = rows.next_column()? else {
            break;
        };
        cells(&column.cells, &mut writer)?;
        writer.close()?;
    }
    rows.close()?;
    file.close()?;
    Ok(())
}

fn field(column: &Column) -> Result<Type, ParquetError> {
    let (physical, repetition) = match column.cells {
        Cells::Text(_) => (Physical::BYTE_ARRAY, Repetition::REQUIRED),
        Cells::Whole(_) => (Physical::INT64, Repetition::OPTIONAL),
        Cells::Number(_) => (Physical::DOUBLE, Repetition::OPTIONAL),
    };
    let logical = matches!(column.cells, Cells::Text(_)).then_some(LogicalType::String);
    Type::primitive_type_builder(column.name, physical)
        .with_repetition(repetition)
        .with_logical_type(logical)
        .build()
}

/// Level 0 is a cell without a number, 1 one that has it; the numbers follow each other.
fn known<N: Copy>(cells: &[Option<N>]) -> (Vec<i16>, Vec<N>) {
    let levels = cells.iter().map(|cell| i16::from(cell.is_some()));
    (levels.collect(), cells.iter().flatten().copied().collect())
}

fn cells(cells: &Cells, writer: &mut SerializedColumnWriter<'_>) -> Result<(), ParquetError> {
    match cells {
        Cells::Text(cells) => {
            let bytes: Vec<ByteArray> = cells.iter().map(|c| c.as_str().into()).collect();
            writer
                .typed::<ByteArrayType>()
                .write_batch(&bytes, None, None)?;
        }
        Cells::Whole(cells) => {
            let (known, numbers) = known(cells);
            writer
                .typed::<Int64Type>()
                .write_batch(&numbers, Some(&known), None)?;
        }
        Cells::Number(cells) => {
            let (known, numbers) = known(cells);
            writer
                .typed::<DoubleType>()
                .write_batch(&numbers, Some(&known), None)?;
        }
    }
    Ok(())
}
