//! Points, apart from their scales: shared registers, what may be written, pages.

use super::{Matter, Review, Row};
use crate::codec::FunctionCode;
use crate::profile::point::Access;

impl Review<'_> {
    pub(super) fn points(&mut self) {
        self.shared_registers();
        self.writes();
        self.pages();
    }

    /// Each pair once, at the one that the file has later. The loader lets only those pass that
    /// different requests read.
    fn shared_registers(&mut self) {
        let points = &self.profile.points;
        let mut pairs: Vec<(Row<'_>, Row<'_>)> = Vec::new();
        for (index, point) in points.iter().enumerate() {
            // By address: as long as one begins before this one ends, it shares registers with it.
            let behind = points[index + 1..].iter();
            let sharing = behind.take_while(|other| other.range.overlaps(point.range));
            for other in sharing {
                let rows = [point, other].map(|point| self.row_of.get(point.name.as_str()));
                if let [Some(one), Some(two)] = rows {
                    let is_earlier = one.place().start < two.place().start;
                    let pair = if is_earlier {
                        (*one, *two)
                    } else {
                        (*two, *one)
                    };
                    if !pairs.contains(&pair) {
                        pairs.push(pair);
                    }
                }
            }
        }
        for (earlier, later) in pairs {
            let other = earlier.table.name.as_ref().clone();
            let line = self.source.line_of(earlier.place().start);
            let matter = Matter::SharedRegisters { other, line };
            self.tell(&later.table.address.span(), later.key("address"), matter);
        }
    }

    fn writes(&mut self) {
        let rows = self.rows.clone();
        let mut written = rows.iter().filter(|row| row.point.access != Access::Read);
        for row in written.clone() {
            let has_bounds = row.point.kind.bounds().is_some();
            let is_bounded = row.point.limits.is_some() || !row.point.writing().allowed.is_empty();
            if has_bounds && !is_bounded {
                self.tell(&row.place(), row.key("range"), Matter::NoRange);
            }
        }
        let functions = [
            FunctionCode::WriteSingleRegister,
            FunctionCode::WriteMultipleRegisters,
        ];
        let answered = &self.profile.limits.functions;
        if functions.iter().any(|function| answered.contains(function)) {
            return;
        }
        if let Some(row) = written.next()
            && let Some(access) = &row.table.access
        {
            self.tell(&access.span(), row.key("access"), Matter::NoWriteFunction);
        }
    }

    fn pages(&mut self) {
        let lacking = |row: &&Row<'_>| row.point.verified && row.point.page.is_empty();
        let rows = self.rows.clone();
        if rows.iter().all(|row| row.point.page.is_empty()) {
            if let Some(first) = rows.iter().find(lacking) {
                self.tell(&first.place(), "points", Matter::NoPages);
            }
            return;
        }
        for row in rows.iter().filter(lacking) {
            self.tell(&row.place(), row.key("page"), Matter::NoPage);
        }
    }
}
