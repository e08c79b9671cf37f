//! The table of errors of one trial.

use crate::kit::{Run, Trial, columns};
use crate::table::Table;

/// One row per technique.
pub fn table(trial: &Trial) -> Table {
    let columns = [
        columns::technique::<(&Trial, &Run)>(),
        columns::rmse(),
        columns::error(),
        columns::leak(),
        columns::acne(),
        columns::megabytes(),
    ];
    Table::new(&columns, "", trial.rows())
}
