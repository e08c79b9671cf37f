//! Warnings of importers and the library, one line each on stderr.

use std::fmt;
use tracing::{Event, Subscriber};
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::fmt::format::{FormatEvent, FormatFields, Writer};
use tracing_subscriber::fmt::{FmtContext, layer};
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::registry::LookupSpan;
use tracing_subscriber::util::SubscriberInitExt;

/// Sends warnings of our own crates to stderr; those of drivers and libraries are too many.
pub fn show() {
    let lines = layer().event_format(Line).with_writer(std::io::stderr).log_internal_errors(false);
    let ours = Targets::new().with_target("antumbra", LevelFilter::WARN);
    // Fails only if a subscriber is installed already; it then shows them.
    let _ = tracing_subscriber::registry().with(lines).with(ours).try_init();
}

struct Line;

impl<S, N> FormatEvent<S, N> for Line
where
    S: Subscriber + for<'a> LookupSpan<'a>,
    N: for<'a> FormatFields<'a> + 'static,
{
    fn format_event(&self, ctx: &FmtContext<'_, S, N>, mut writer: Writer<'_>, event: &Event<'_>) -> fmt::Result {
        write!(writer, "{}: ", event.metadata().level().as_str().to_lowercase().replace("warn", "warning"))?;
        ctx.field_format().format_fields(writer.by_ref(), event)?;
        writeln!(writer)
    }
}
