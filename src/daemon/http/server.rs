//! Listening: one thread, one task a connection.

use std::convert::Infallible;
use std::future::{Future, poll_fn, ready};
use std::net::{SocketAddr, TcpListener};
use std::pin::{Pin, pin};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::task::{Context, Poll};
use std::thread::JoinHandle;
use std::time::Duration;

use hyper::Request;
use hyper::rt::{Read, ReadBufCursor, Write};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use rustix::net::sockopt;
use tokio::sync::oneshot;

use super::Answer;
use super::bounds::{
    ConnectionTable, HEAD_BYTES, HEAD_FIELDS, HEAD_TIME, OutgoingRate, PIECE, Progress,
    SOCKET_BUFFER,
};
use super::upgrade::{Follow, Upgrade};
use sculptd_devices::Clock;

/// Interval at which the bounds of connections are checked.
const LOOK: Duration = Duration::from_millis(250);
/// Wait after a connection that could not be accepted (too many open files).
const AGAIN: Duration = Duration::from_millis(100);

/// Answers one request. It runs on the server's thread, so it must be quick.
pub type Handler = dyn Fn(&Request<()>) -> Answer + Send + Sync;

/// A listening server; closed, with every connection, when dropped.
#[derive(Debug)]
pub struct HttpServer {
    at: SocketAddr,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl HttpServer {
    /// Listens on `at` and answers with `handler`, on a thread named `thread`. The handler is
    /// created from the address and the table of connections. If port 0 was requested, the address
    /// has the port that the system chose.
    ///
    /// # Errors
    /// Returns the system's error for the address or the thread.
    pub fn start<H>(
        at: SocketAddr,
        thread: &str,
        handler: impl FnOnce(SocketAddr, Arc<ConnectionTable>) -> H,
    ) -> std::io::Result<Self>
    where
        H: Fn(&Request<()>) -> Answer + Send + Sync + 'static,
    {
        let listener = TcpListener::bind(at)?;
        listener.set_nonblocking(true)?;
        // Connections inherit them.
        sockopt::set_socket_send_buffer_size(&listener, SOCKET_BUFFER)?;
        sockopt::set_socket_recv_buffer_size(&listener, HEAD_BYTES * 2)?;
        let at = listener.local_addr()?;
        let places = Arc::new(ConnectionTable::default());
        let handler: Arc<Handler> = Arc::new(handler(at, places.clone()));
        let runtime =
            tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build()?;
        let (stop, stopped) = oneshot::channel();
        let thread = std::thread::Builder::new().name(thread.into()).spawn(move || {
            runtime.block_on(async {
                match tokio::net::TcpListener::from_std(listener) {
                    Ok(listener) => accept(&listener, &places, &handler, stopped).await,
                    Err(e) => tracing::error!("{at}: {e}"),
                }
            });
            // Dropping the runtime ends every connection.
        })?;
        Ok(HttpServer { at, stop: Some(stop), thread: Some(thread) })
    }

    /// Returns the address of the listening socket.
    pub fn address(&self) -> SocketAddr {
        self.at
    }
}

impl Drop for HttpServer {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Accepts until `stopped` says that the server was dropped.
async fn accept(
    listener: &tokio::net::TcpListener,
    places: &Arc<ConnectionTable>,
    handler: &Arc<Handler>,
    mut stopped: oneshot::Receiver<()>,
) {
    let clock = Clock::monotonic();
    let pace = Arc::new(OutgoingRate::new(clock.clone()));
    let next_number = AtomicU64::new(0);
    loop {
        let accepted = poll_fn(|context| match Pin::new(&mut stopped).poll(context) {
            Poll::Ready(_) => Poll::Ready(None),
            Poll::Pending => listener.poll_accept(context).map(Some),
        });
        let stream = match accepted.await {
            None => return,
            Some(Err(_)) => {
                tokio::time::sleep(AGAIN).await;
                continue;
            }
            Some(Ok((stream, _))) => stream,
        };
        places.make_room();
        let number = next_number.fetch_add(1, Relaxed);
        let progress = Arc::new(Progress::begin(clock.now_us()));
        let counted = CountedStream {
            inner: TokioIo::new(stream),
            progress: progress.clone(),
            clock: clock.clone(),
        };
        let guard = ConnectionGuard { places: places.clone(), number };
        let served = serve(counted, progress.clone(), handler.clone(), pace.clone(), clock.clone());
        let task = tokio::spawn(async move {
            let _guard = guard;
            served.await;
        });
        places.enter(number, progress, task.abort_handle());
        // Connections that gave way close before the next one comes.
        tokio::task::yield_now().await;
    }
}

/// Strikes the connection out however it ended.
struct ConnectionGuard {
    places: Arc<ConnectionTable>,
    number: u64,
}

impl Drop for ConnectionGuard {
    fn drop(&mut self) {
        self.places.leave(self.number);
    }
}

/// Answers one request, and ends the connection where it leaves its bounds.
async fn serve(
    stream: CountedStream,
    progress: Arc<Progress>,
    handler: Arc<Handler>,
    pace: Arc<OutgoingRate>,
    clock: Clock,
) {
    let (asked, time) = (progress.clone(), clock.clone());
    let service = service_fn(move |request: Request<hyper::body::Incoming>| {
        asked.asked(time.now_us());
        // The body of a request is not read.
        let mut request = request.map(|_| ());
        let mut answer = handler(&request);
        if let Some(follows) = answer.upgrade.as_mut().and_then(Upgrade::take) {
            tokio::spawn(follow(hyper::upgrade::on(&mut request), follows));
        }
        ready(Ok::<_, Infallible>(answer.respond(pace.clone())))
    });
    let connection = http1::Builder::new()
        // Every answer but a change of protocol says that it is the last.
        .keep_alive(true)
        .half_close(true)
        .max_header_size(HEAD_BYTES)
        .max_headers(HEAD_FIELDS)
        .max_buf_size(PIECE)
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD_TIME)
        .serve_connection(stream, service)
        .with_upgrades();
    let mut connection = pin!(connection);
    while tokio::time::timeout(LOOK, connection.as_mut()).await.is_err() {
        if !progress.within_bounds(clock.now_us()) {
            return;
        }
    }
}

/// Hands the socket over once the response to its request has gone out.
async fn follow(upgraded: hyper::upgrade::OnUpgrade, follows: Follow) {
    let Ok(upgraded) = upgraded.await else { return };
    let Ok(parts) = upgraded.downcast::<CountedStream>() else { return };
    let stream = parts.io.inner.into_inner().into_std();
    match stream.and_then(|s| s.set_nonblocking(false).map(|()| s)) {
        Ok(stream) => follows(stream, parts.read_buf.to_vec()),
        Err(e) => tracing::warn!("a connection was lost as it changed its protocol: {e}"),
    }
}

/// A connection whose bytes are counted as they go out.
#[derive(Debug)]
struct CountedStream {
    inner: TokioIo<tokio::net::TcpStream>,
    progress: Arc<Progress>,
    clock: Clock,
}

impl CountedStream {
    fn count(&self, written: Poll<std::io::Result<usize>>) -> Poll<std::io::Result<usize>> {
        if let Poll::Ready(Ok(bytes)) = &written {
            self.progress.sent(self.clock.now_us(), *bytes);
        }
        written
    }
}

impl Read for CountedStream {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: ReadBufCursor<'_>,
    ) -> Poll<std::io::Result<()>> {
        Pin::new(&mut self.inner).poll_read(context, buffer)
    }
}

impl Write for CountedStream {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<std::io::Result<usize>> {
        let written = Pin::new(&mut self.inner).poll_write(context, bytes);
        self.count(written)
    }

    fn is_write_vectored(&self) -> bool {
        self.inner.is_write_vectored()
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        parts: &[std::io::IoSlice<'_>],
    ) -> Poll<std::io::Result<usize>> {
        let written = Pin::new(&mut self.inner).poll_write_vectored(context, parts);
        self.count(written)
    }

    fn poll_flush(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<std::io::Result<()>> {
        Pin::new(&mut self.inner).poll_flush(context)
    }

    fn poll_shutdown(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<std::io::Result<()>> {
        Pin::new(&mut self.inner).poll_shutdown(context)
    }
}
