//! Text in columns, two spaces apart.

use comfy_table::{CellAlignment, Table, presets};

/// Lays out a header and lines of cells; columns whose index is in `right` are aligned right. No
/// line ends in spaces.
pub fn columns(
    header: &[&str],
    right: &[usize],
    lines: impl IntoIterator<Item = Vec<String>>,
) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    table.set_header(header.to_vec());
    table.add_rows(lines);
    for (index, column) in table.column_iter_mut().enumerate() {
        column.set_padding((0, 2));
        if right.contains(&index) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    let mut text = String::new();
    for line in table.lines() {
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}
